// SPDX-License-Identifier: Apache-2.0
#pragma once
// The one coordinate formula: P(q) = T (sum q_lin e_lin + R1 R2 ... sum q_dist e_dist), circular axes in document
// order, first outermost.
//
//   const CoordinateFrame polar({}, {{"r", AxisKind::distance, {1, 0, 0}}, {"phi", AxisKind::circular, {0, 0, 1}}});
//   const double q[] = {2, std::numbers::pi / 2};
//   polar.point(q);  // (0, 2, 0) up to rounding
//
// Lengths of q and of the result are in the unit of T's translation: millimetres in everything that evaluation hands
// out. Angles are radians. Values; const functions may run on any thread.

#include <span>
#include <string>
#include <vector>

#include "meso/base/vec.hpp"
#include "meso/model/document.hpp"

namespace meso::eval {

struct CoordinateAxis {
  std::string name;
  AxisKind kind = AxisKind::linear;
  Vec3 direction;  ///< unit, in the placed frame; zero for scalar axes
};

/// A coordinate system with its ancestors' placements multiplied in.
class CoordinateFrame {
 public:
  CoordinateFrame(Affine world_from_system, std::vector<CoordinateAxis> axes);

  [[nodiscard]] const std::vector<CoordinateAxis>& axes() const { return axes_; }
  [[nodiscard]] const Affine& world_from_system() const { return world_from_system_; }
  /// P(q); q has one value per axis.
  [[nodiscard]] Vec3 point(std::span<const double> q) const;
  /// P(q) with the local orientation T's rotation times R1 R2 ...
  [[nodiscard]] Affine frame(std::span<const double> q) const;
  /// R1 R2 ... alone.
  [[nodiscard]] Mat3 turn(std::span<const double> q) const;
  /// P(q) where turn(q) is known already; `offset` is added beside the linear axes.
  [[nodiscard]] Vec3 point(std::span<const double> q, const Mat3& turn, Vec3 offset) const;
  /// True if no axis is circular: P is affine.
  [[nodiscard]] bool is_straight() const { return circular_.empty(); }
  /// The same frame with every length multiplied by `factor`.
  [[nodiscard]] CoordinateFrame scaled(double factor) const;

 private:
  Affine world_from_system_;
  std::vector<CoordinateAxis> axes_;
  std::vector<std::size_t> circular_;
};

}  // namespace meso::eval
