// SPDX-License-Identifier: Apache-2.0
#include "solid.hpp"

#include <algorithm>
#include <memory>

#include "affine_inverse.hpp"
#include "meso/eval/bounds.hpp"
#include "primitives.hpp"

namespace meso::membership {
namespace {

using Solids = std::vector<Solid>;

Solid nothing_known() {
  return {anywhere, [](Vec3) { return Answer::unknown; }};
}

Solid union_of(Solids solids) {
  if (solids.size() == 1) return std::move(solids.front());
  Box3 box;
  for (const Solid& solid : solids) box = united(box, solid.box);
  return {box, [solids = std::move(solids)](Vec3 p) {
            Answer answer = Answer::outside;
            for (std::size_t i = 0; i < solids.size() && answer != Answer::inside; ++i)
              answer = std::max(answer, solids[i].at(p));
            return answer;
          }};
}

Solid intersection_of(Solids solids) {
  Box3 box = solids.front().box;
  for (const Solid& solid : solids) box = common(box, solid.box);
  return {box, [solids = std::move(solids)](Vec3 p) {
            Answer answer = Answer::inside;
            for (std::size_t i = 0; i < solids.size() && answer != Answer::outside; ++i)
              answer = std::min(answer, solids[i].at(p));
            return answer;
          }};
}

Solid difference_of(Solids solids) {
  const Box3 box = solids.front().box;
  return {box, [solids = std::move(solids)](Vec3 p) {
            Answer answer = solids.front().at(p);
            for (std::size_t i = 1; i < solids.size() && answer != Answer::outside; ++i)
              answer = std::min(answer, complement(solids[i].at(p)));
            return answer;
          }};
}

class Maker {
 public:
  explicit Maker(const Surroundings& surroundings) : surroundings_(surroundings) {}

  Solid make(const eval::Shape& shape) const {
    const Box3 box = eval::bounds(shape).value_or(anywhere);
    return std::visit([&](const auto& s) { return make(s, box); }, shape.value);
  }

 private:
  template <class Primitive>
  Solid make(const Primitive& primitive, const Box3& box) const {
    const auto shared = std::make_shared<const Primitive>(primitive);
    return {box, [shared](Vec3 p) { return known(contains(*shared, p)); }};
  }
  Solid make(const eval::VolumeElementShape& element, const Box3& box) const {
    return {box, [element](Vec3 p) { return answer_at(element, p); }};
  }
  Solid make(const eval::BooleanShape& shape, const Box3&) const {
    Solids solids = make_all(shape.operands);
    if (solids.empty()) return {};
    switch (shape.operation) {
      case BooleanOperation::union_:
        return union_of(std::move(solids));
      case BooleanOperation::intersection:
        return intersection_of(std::move(solids));
      case BooleanOperation::difference:
        break;
    }
    return difference_of(std::move(solids));
  }
  Solid make(const eval::TransformedShape& shape, const Box3&) const {
    return moved(union_of(make_all(shape.operands)), shape.map);
  }
  Solid make(const eval::ImportShape& import, const Box3&) const {
    const auto read = surroundings_.imports ? surroundings_.imports(import) : std::nullopt;
    if (!read) return nothing_known();
    const double s = import.scale;
    const Affine scaled{Mat3::from_columns({s, 0, 0}, {0, s, 0}, {0, 0, s}), {}};
    return moved({read->box, [inside = read->inside](Vec3 p) { return known(inside(p)); }}, import.transform * scaled);
  }
  Solid make(const eval::ImplicitShape&, const Box3&) const { return nothing_known(); }
  Solid make(const eval::PartShape& shape, const Box3&) const { return surroundings_.part(shape.part); }

  Solids make_all(const std::vector<eval::Shape>& shapes) const {
    Solids solids;
    for (const eval::Shape& shape : shapes) solids.push_back(make(shape));
    return solids;
  }

  const Surroundings& surroundings_;
};

}  // namespace

Solid make_solid(const eval::Shape& shape, const Surroundings& surroundings) { return Maker(surroundings).make(shape); }

Solid moved(Solid solid, const Affine& map) {
  if (map == Affine{} || solid.box.empty()) return solid;
  return {eval::transformed(map, solid.box),
          [solid = std::move(solid), back = inverse(map)](Vec3 p) { return solid.at(back * p); }};
}

}  // namespace meso::membership
