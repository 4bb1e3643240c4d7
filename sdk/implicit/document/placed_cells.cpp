// SPDX-License-Identifier: Apache-2.0
#include "placed_cells.hpp"

#include <algorithm>

#include "cell_bricks.hpp"
#include "cell_period.hpp"

namespace meso::implicit {

PlacedCells::PlacedCells(PrimitiveIndex index, double reach) : index_(std::move(index)), reach_(reach) {
  for (const Primitive& p : index_.primitives()) lipschitz_ = std::max(lipschitz_, p.placed.lipschitz);
}

double PlacedCells::value(Vec3 p) const {
  double least = reach_;
  const Vec3 half{reach_, reach_, reach_};
  index_.visit({p - half, p + half}, [&](const Primitive& primitive, Vec3 displacement) {
    least = std::min(least, primitive.value(p - displacement));
  });
  return least;
}

Interval PlacedCells::interval(const Box3& box) const {
  const Vec3 middle = 0.5 * box.min + 0.5 * box.max;
  const double radius = norm(box.max - middle) * (1 + 1e-12);
  Interval result{reach_, reach_};
  // In a box that holds whole cells nothing is to be found out.
  if (!(radius <= 2 * reach_)) return {-HUGE_VAL, reach_};
  const Vec3 half{radius + reach_, radius + reach_, radius + reach_};
  index_.visit({middle - half, middle + half}, [&](const Primitive& primitive, Vec3 displacement) {
    if (primitive.is_capsule()) {
      const double d = primitive.value(middle - displacement), slack = radius + 1e-12 * (std::abs(d) + radius);
      result.lo = std::min(result.lo, d - slack);
      result.hi = std::min(result.hi, d + slack);
    } else {
      const Interval one = primitive.placed.interval({box.min - displacement, box.max - displacement});
      result.lo = std::min(result.lo, one.lo);
      if (!one.undefined) result.hi = std::min(result.hi, one.hi);
    }
  });
  return result;
}

Box3 PlacedCells::bounds(double level) const {
  if (level >= reach_) return {{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, HUGE_VAL, HUGE_VAL}};
  const double grown = std::max(level, 0.0);
  const Vec3 by{grown, grown, grown};
  return index_.box().empty() ? Box3{} : Box3{index_.box().min - by, index_.box().max + by};
}

std::unique_ptr<ExternalField::Prepared> PlacedCells::prepare(const Grid& grid, const Affine& field_from_grid,
                                                              double band, const RunOptions& run) const {
  return prepare_bricks(shared_from_this(), grid, field_from_grid, band, run);
}

std::uint64_t PlacedCells::prepared_bytes(const Grid& grid) const {
  const auto nodes = [&](std::size_t axis) { return static_cast<std::uint64_t>(grid.nodes[axis]); };
  const bool has_fields = std::any_of(index_.primitives().begin(), index_.primitives().end(),
                                      [](const Primitive& p) { return !p.is_capsule(); });
  return (index_.repetition() ? CellPeriod::most_bytes(grid.node_count()) : 0) +
         (has_fields ? nodes(0) * nodes(1) * sizeof(double) : 0);
}

}  // namespace meso::implicit
