// SPDX-License-Identifier: Apache-2.0
#include "lattice/circles_apart.hpp"

#include <cmath>
#include <set>

namespace meso::brep {
namespace {

/// Of the radius. Circles of struts at right angles are then 2e-4 radians apart, at 60 degrees 1.2e-4: a thousand times
/// as far as OpenCASCADE knows its vertices.
constexpr double gain = 1e-4;

/// Centres and radii of the balls that are the round ends of struts and no more.
class RoundEnds {
 public:
  explicit RoundEnds(const CellShape& cell) : quantum_(cell.tolerance()) {
    for (const CellPrimitive& primitive : cell.primitives)
      if (const auto* strut = std::get_if<Frustum>(&primitive)) {
        all_.insert(key(strut->start, strut->start_radius));
        all_.insert(key(strut->end, strut->end_radius));
      }
  }
  [[nodiscard]] bool has(const Ball& ball) const { return all_.contains(key(ball.centre, ball.radius)); }

 private:
  [[nodiscard]] std::array<std::int64_t, 4> key(Vec3 p, double radius) const {
    return {std::llround(p.x / quantum_), std::llround(p.y / quantum_), std::llround(p.z / quantum_),
            std::llround(radius / quantum_)};
  }

  double quantum_;
  std::set<std::array<std::int64_t, 4>> all_;
};

}  // namespace

std::optional<CellShape> with_circles_apart(const CellShape& cell) {
  const RoundEnds ends(cell);
  LatticeCell wider{cell.box, cell.primitives};
  bool has_changed = false;
  for (CellPrimitive& primitive : wider.primitives)
    if (auto* ball = std::get_if<Ball>(&primitive); ball != nullptr && !ends.has(*ball)) {
      ball->radius *= 1 + gain;
      has_changed = true;
    }
  if (!has_changed) return {};
  DiagnosticSink sink;  // what fails with larger balls has failed before
  auto shape = cell_shape(wider, sink);
  if (!shape) return {};
  shape->cut_to_box = cell.cut_to_box;
  shape->varied = cell.varied;
  return shape;
}

}  // namespace meso::brep
