// SPDX-License-Identifier: Apache-2.0
#pragma once
// Triangles for the faces of beams: between the two circles of a strut, and on what circles leave of a ball. Private.
//
// Points on circles come from the caller and stay as they are, so neighbours agree. Thread rule: pure.

#include <optional>
#include <span>
#include <vector>

#include "meso/brep/body.hpp"

namespace meso::brep {

/// A point of a circle and its turn about the strut's axis from the seam, rising; first and last are one point.
struct RingPoint {
  Vec3 point;
  double turn = 0;
};
/// `upper` lies along the axis about which turns are counted, seen from `lower`. Outward triangles.
[[nodiscard]] Triangulation strut_mesh(std::span<const RingPoint> lower, std::span<const RingPoint> upper);

/// The face on the left of the loops, about `deflection` from the sphere at most. `holes` are
/// directions from the centre through the circles that bound it. Empty if the loops are too coarse.
[[nodiscard]] std::optional<Triangulation> sphere_mesh(const SphereSurface& sphere,
                                                       const std::vector<std::vector<Vec3>>& loops, double deflection,
                                                       double angle, std::span<const Vec3> holes);

}  // namespace meso::brep
