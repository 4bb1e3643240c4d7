// SPDX-License-Identifier: Apache-2.0
#include "meso/eval/coordinates.hpp"

#include <cassert>

namespace meso::eval {

CoordinateFrame::CoordinateFrame(Affine world_from_system, std::vector<CoordinateAxis> axes)
    : world_from_system_(world_from_system), axes_(std::move(axes)) {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (axes_[i].kind == AxisKind::circular) circular_.push_back(i);
  }
}

Mat3 CoordinateFrame::turn(std::span<const double> q) const {
  Mat3 turn;
  for (const std::size_t i : circular_) turn = turn * rotation(axes_[i].direction, q[i]);
  return turn;
}

Vec3 CoordinateFrame::point(std::span<const double> q, const Mat3& turn, Vec3 offset) const {
  assert(q.size() == axes_.size());
  Vec3 linear = offset, distance;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (axes_[i].kind == AxisKind::linear) linear += q[i] * axes_[i].direction;
    if (axes_[i].kind == AxisKind::distance) distance += q[i] * axes_[i].direction;
  }
  return world_from_system_ * (linear + turn * distance);
}

Vec3 CoordinateFrame::point(std::span<const double> q) const { return point(q, turn(q), {}); }

Affine CoordinateFrame::frame(std::span<const double> q) const {
  const Mat3 turned = turn(q);
  return {world_from_system_.linear * turned, point(q, turned, {})};
}

CoordinateFrame CoordinateFrame::scaled(double factor) const {
  CoordinateFrame result = *this;
  result.world_from_system_.translation = factor * world_from_system_.translation;
  return result;
}

}  // namespace meso::eval
