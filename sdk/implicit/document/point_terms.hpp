// SPDX-License-Identifier: Apache-2.0
#pragma once
// Functions of the point that no expression can say, as terms: a quantity of a vector field,
// the distance to a level, the phase of cells that grow along an axis. Private.

#include <memory>
#include <vector>

#include "meso/eval/evaluation.hpp"
#include "meso/implicit/density_table.hpp"
#include "meso/implicit/field.hpp"

namespace meso::implicit {

/// The quantity at the world's point. Where it has no value (outside of its records) it is that of the nearest point of
/// `region`; what the document calls an error there was looked for before.
[[nodiscard]] Term quantity_term(eval::PointQuantity quantity, const Box3& region);

/// Signed distance to {f = 0}, negative where f is: the nearest point is found by Newton's steps along the gradient and
/// slides along the surface until the way to it is perpendicular. Good within the radius of the surface's curvature,
/// and up to `reach`: beyond it is some distance that is larger. `step`: how far one step may go at most, a part of a
/// cell.
[[nodiscard]] Term distance_to_level(const Term& f, double step, double reach);

/// The integral of 1 / size from `start` to the coordinate, for sizes that are a function of it. Beyond the range it
/// goes on straight.
class AxisPhase {
 public:
  /// `size`: a term of the coordinate x, in its unit.
  AxisPhase(const Term& size, double start, double from, double to);
  [[nodiscard]] double at(double q) const;
  [[nodiscard]] Interval at(Interval q) const { return {at(q.lo), at(q.hi), q.undefined}; }

 private:
  double from_, spacing_;
  std::vector<double> phase_, slope_;  ///< at equal steps
};
[[nodiscard]] Term phase_term(std::shared_ptr<const AxisPhase> phase, const Term& coordinate);

}  // namespace meso::implicit
