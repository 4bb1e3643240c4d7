// SPDX-License-Identifier: Apache-2.0
#pragma once
// Which level of a function bounds a given share of a box: the volume-fraction table of a body.
//
//   const DensityTable table([&](auto) { return gyroid; }, {{0, 0, 0}, {1, 1, 1}}, {});
//   const double level = table.level(0.3, {});      // {gyroid <= level} fills 30 % of the box
//   density_level(table, share, {})                 // the same as a term, share being one
//
// The function is sampled at the points of a quasi-random sequence in the box, once for each node of a grid over the
// values that differ from point to point; a level is a quantile of these samples, linear between nodes. With 2^18
// samples a share is off by less than 1e-3, mostly by 2e-4.

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "meso/base/vec.hpp"
#include "meso/implicit/interval.hpp"
#include "meso/implicit/term.hpp"

namespace meso::implicit {

class DensityTable {
 public:
  struct Room {
    Vec3 corner, size;
  };
  /// A function of the point, for values of what differs from point to point.
  using Function = std::function<Term(std::span<const double>)>;
  /// REQUIRES: at most two ranges.
  DensityTable(const Function& function, const Room& room, std::vector<Interval> ranges);

  /// Ranges that are left count at their ends.
  [[nodiscard]] double level(double share, std::span<const double> at) const;
  [[nodiscard]] Interval level(Interval share, std::span<const Interval> at) const;

  /// Shares that no level bounds, because the function is flat: between `from` and `to`.
  struct Gap {
    double from = 0, to = 0;
  };
  /// Of the node nearest to the values.
  [[nodiscard]] std::span<const Gap> gaps(std::span<const double> at) const;

 private:
  struct Node {
    std::vector<double> quantiles;
    std::vector<Gap> gaps;
  };
  [[nodiscard]] std::size_t nodes_along(std::size_t axis) const { return ranges_.size() > axis ? nodes_ : 1; }
  [[nodiscard]] double position(double value, std::size_t axis) const;
  [[nodiscard]] const Node& node(std::size_t i, std::size_t j) const { return table_[j * nodes_along(0) + i]; }

  std::vector<Interval> ranges_;
  std::size_t nodes_ = 1;  ///< along each range
  std::vector<Node> table_;
};

/// table.level(share, at) at every point.
[[nodiscard]] Term density_level(std::shared_ptr<const DensityTable> table, const Term& share, std::vector<Term> at);

/// The root of the mean of a function's square over the box. For sums of sines, and their period, it is exact.
[[nodiscard]] double root_mean_square(const Term& function, const DensityTable::Room& box);

/// Points of the unit cube that fill it evenly, and lie on no plane of symmetry.
[[nodiscard]] std::vector<Vec3> even_points(std::size_t count);

}  // namespace meso::implicit
