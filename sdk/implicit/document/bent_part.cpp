// SPDX-License-Identifier: Apache-2.0
#include "bent_part.hpp"

#include <array>
#include <cmath>

#include "coordinate_inverse.hpp"
#include "meso/implicit/point_function.hpp"
#include "volume_element.hpp"

namespace meso::implicit {
namespace {

/// Of a function with leaves that are asked, which no term takes along: struts, meshes.
class Bent final : public PointFunction {
 public:
  Bent(const Term& solid, const std::array<Term, 3>& source)
      : solid_(solid), source_{FlatTerm(source[0]), FlatTerm(source[1]), FlatTerm(source[2])} {}

  void values(std::span<const Vec3> points, double* out) const override {
    std::vector<Vec3> sources(points.size());
    for (std::size_t a = 0; a < 3; ++a) {
      source_[a].values(points, {out, points.size()});
      for (std::size_t n = 0; n < points.size(); ++n) sources[n][a] = out[n];
    }
    solid_.values(sources, {out, points.size()});
  }
  [[nodiscard]] Interval interval(const Box3& box) const override {
    Box3 from;
    for (std::size_t a = 0; a < 3; ++a) {
      const Interval range = source_[a].interval(box);
      if (range.undefined || !std::isfinite(range.lo) || !std::isfinite(range.hi)) return Interval::everything();
      from.min[a] = range.lo, from.max[a] = range.hi;
    }
    return solid_.interval(from);
  }

 private:
  FlatTerm solid_;
  std::array<FlatTerm, 3> source_;
};

}  // namespace

std::optional<Field> bent_part(const eval::CellStream& cells, const eval::PlacedCell& cell, const Field& part,
                               const Reporter& report) {
  if (!cells.unit_cell().clip_to_box.value_or(false)) {
    report(Code::conformal_not_realised, cells.unit_cell().id_in_source, {"a part that is not cut to its box"});
    return std::nullopt;
  }
  const auto box = cells.cell_box(cell, report.sink());
  const auto region = box ? cells.cell_region(cell, report.sink()) : std::nullopt;
  if (!region) return std::nullopt;
  const auto& element = std::get<eval::VolumeElementShape>(region->value);
  std::array<double, 3> middle{};
  for (std::size_t a = 0; a < 3; ++a) middle[a] = (element.from[a] + element.to[a]) / 2;
  const auto q = coordinates_of(*element.system, element.axes, middle);
  const auto walls = q ? volume_element(element) : std::nullopt;
  if (!walls) {
    report(Code::conformal_not_inverted, cells.pattern().id_in_source, {});
    return std::nullopt;
  }
  std::array<Term, 3> source;
  for (std::size_t a = 0; a < 3; ++a) {
    const double edge = box->size[a] / cell.step[a];
    source[a] = edge * (*q)[a].q - (edge * cell.q[a] - box->corner[a]);
  }
  const Term solid = part.term();
  const Field bent = solid.has_external() ? Field::external(std::make_shared<const Bent>(solid, source))
                                          : Field::from_term(solid.with(source));
  return intersection_of(bent, *walls);
}

}  // namespace meso::implicit
