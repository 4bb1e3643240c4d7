// SPDX-License-Identifier: Apache-2.0
#include "cell_primitives.hpp"

#include <algorithm>

#include "affine_map.hpp"
#include "bent_part.hpp"
#include "meso/eval/bounds.hpp"
#include "placed_cells.hpp"

namespace meso::implicit {
namespace {

/// The factor of a map that keeps all angles; 0 for any other.
double uniform_scale(const Mat3& m) {
  const Mat3 s = transposed(m) * m;
  const double square = (s(0, 0) + s(1, 1) + s(2, 2)) / 3;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      if (std::abs(s(i, j) - (i == j ? square : 0)) > 1e-12 * square) return 0;
  return std::abs(square - 1) < 1e-12 ? 1 : std::sqrt(square);
}

void add_capsule(Vec3 from, Vec3 to, double radius, std::vector<Primitive>& into) {
  Primitive p{.capsule = capsule(from, to, radius + seam)};
  const Vec3 by{p.capsule.radius, p.capsule.radius, p.capsule.radius};
  for (const Vec3 end : {from, to}) {
    p.box.extend(end - by);
    p.box.extend(end + by);
  }
  into.push_back(std::move(p));
}

void add_cone(Vec3 from, Vec3 to, const Cone& cone, std::vector<Primitive>& into) {
  const std::size_t count = into.size();
  const Field upright = Field::cone(cone.bottom, cone.top, cone.height);
  add_field(upright, into);
  if (into.size() == count) return;
  const Vec3 z = (to - from) / norm(to - from), aside = std::abs(z.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 y = cross(z, aside) / norm(cross(z, aside));
  const Affine map{Mat3::from_columns(cross(y, z), y, z), from};
  Primitive& p = into.back();
  p.placed.cone = cone;
  p.placed.grown = seam;
  p.placed.local_from_world = inverse(map);
  p.box = upright.oriented(to - from).translated(from).bounds(seam);
}

/// A strut's end: the half of a ball beyond the disc.
Field hemisphere(Vec3 end, Vec3 outwards, double radius) {
  return intersection_of(Field::ball(radius), Field::half_space(-outwards)).translated(end);
}

}  // namespace

void add_field(const Field& field, std::vector<Primitive>& into) {
  Box3 box = field.bounds(seam);
  if (box.empty()) return;
  into.push_back(
      {.placed = {.field = std::make_shared<const FlatTerm>(field.offset(seam).term()), .lipschitz = field.lipschitz()},
       .box = box});
}

Primitive placed(const Primitive& primitive, const Affine& map) {
  if (map == Affine{}) return primitive;
  Primitive result = primitive;
  result.box = eval::transformed(map, primitive.box);
  if (primitive.is_capsule()) {
    const Capsule& c = primitive.capsule;
    const double factor = uniform_scale(map.linear);
    const Vec3 axis = map.linear * c.axis;
    const double length2 = dot(axis, axis);
    result.capsule = {map * c.from, axis, length2 > 0 ? 1 / length2 : 0, factor * c.radius};
  } else {
    result.placed.local_from_world = primitive.placed.local_from_world * inverse(map);
    result.placed.factor = primitive.placed.factor * least_stretch(map.linear);
  }
  return result;
}

void CellPrimitives::add_beams(const eval::BeamsShape& beams, std::vector<Primitive>& into) {
  for (const eval::Strut& s : beams.struts) {
    const Vec3 from = beams.nodes[s.from].position, to = beams.nodes[s.to].position;
    const double length = norm(to - from);
    smallest_ = std::min(smallest_, 2 * std::min(s.radius_from, s.radius_to));
    const auto is_ball = [&](BeamCap cap) {
      return cap == BeamCap::sphere ||
             (cap == BeamCap::hemisphere && s.radius_from == s.radius_to && length >= s.radius_from);
    };
    if (s.radius_from == s.radius_to && is_ball(s.cap_from) && is_ball(s.cap_to)) {
      add_capsule(from, to, s.radius_from, into);
      continue;
    }
    if (s.cap_from == BeamCap::hemisphere || s.cap_to == BeamCap::hemisphere) {
      const Vec3 along = (to - from) / length;
      Field strut = Field::cone(s.radius_from, s.radius_to, length).oriented(to - from).translated(from);
      if (s.cap_from == BeamCap::hemisphere) strut = joined(strut, hemisphere(from, -along, s.radius_from));
      if (s.cap_to == BeamCap::hemisphere) strut = joined(strut, hemisphere(to, along, s.radius_to));
      add_field(strut, into);
    } else {
      add_cone(from, to, {s.radius_from, s.radius_to, length}, into);
    }
    if (s.cap_from == BeamCap::sphere) add_capsule(from, from, s.radius_from, into);
    if (s.cap_to == BeamCap::sphere) add_capsule(to, to, s.radius_to, into);
  }
  for (const eval::StrutNode& node : beams.nodes) {
    if (node.ball_radius <= 0) continue;
    smallest_ = std::min(smallest_, 2 * node.ball_radius);
    add_capsule(node.position, node.position, node.ball_radius, into);
  }
}

bool CellPrimitives::add_bent_part(const PartBody& body, const eval::PlacedCell& cell, std::vector<Primitive>& made) {
  if (!part_) part_ = shapes_.make({eval::PartShape{evaluation_.find_part(body.part.text)}, body.id_in_source});
  const auto bent = part_ ? bent_part(cells_, cell, *part_, report_) : std::nullopt;
  if (!bent) return false;
  add_field(*bent, made);
  return true;
}

bool CellPrimitives::make(const eval::PlacedCell& cell, std::vector<Primitive>& made) {
  const auto* part = std::get_if<PartBody>(&cells_.unit_cell().body);
  if (part != nullptr && cell.mapping == CellMapping::conformal) return add_bent_part(*part, cell, made);
  const auto shape = cells_.shape(cell, report_.sink());
  if (!shape) return false;
  const bool clipped = cells_.unit_cell().clip_to_box.value_or(false);
  const auto* beams = std::get_if<eval::BeamsShape>(&shape->value);
  if (beams != nullptr) {
    add_beams(*beams, made);
  } else if (const auto* ball = std::get_if<eval::SphereShape>(&shape->value)) {
    smallest_ = std::min(smallest_, 2 * ball->radius);
    add_capsule(ball->center, ball->center, ball->radius, made);
  } else {
    const auto field = shapes_.make(*shape);
    if (!field) return false;
    add_field(*field, made);
  }
  // A strut under a map that keeps no angles is no capsule any more.
  const bool bent = cell.mapping == CellMapping::rigid && uniform_scale(cell.world_from_cell.linear) == 0;
  const bool has_capsules = std::ranges::any_of(made, &Primitive::is_capsule);
  if (!(clipped || (bent && has_capsules)) || made.empty()) return true;
  const double reach = 4 * smallest_;
  Field whole = Field::external(
      std::make_shared<const PlacedCells>(PrimitiveIndex(std::move(made), {}), std::isfinite(reach) ? reach : 1));
  made.clear();
  if (clipped) {
    const std::size_t errors = report_.sink().error_count();
    const auto region = cells_.cell_region(cell, report_.sink());
    if (report_.sink().error_count() > errors) return false;
    const auto box = region ? shapes_.make(*region) : std::nullopt;
    if (!box) return false;
    whole = intersection_of(whole, *box);
  }
  add_field(whole, made);
  return true;
}

bool CellPrimitives::add(const eval::PlacedCell& cell, std::vector<Primitive>& into) {
  const Affine placement = cell.mapping == CellMapping::rigid ? cell.world_from_cell : Affine{};
  std::vector<Primitive> fresh;
  const std::vector<Primitive>* made = &fresh;
  if (cells_.shape_varies()) {
    if (!make(cell, fresh)) return false;
  } else {
    std::vector<double> key(cell.parameters.begin(), cell.parameters.end());
    key.push_back(uniform_scale(placement.linear) == 0 ? 1 : 0);
    auto found = known_.find(key);
    if (found == known_.end()) {
      if (!make(cell, fresh)) return false;
      found = known_.emplace(std::move(key), std::move(fresh)).first;
    }
    made = &found->second;
  }
  for (const Primitive& p : *made) into.push_back(placed(p, placement));
  return true;
}

}  // namespace meso::implicit
