// SPDX-License-Identifier: Apache-2.0
#pragma once
// What circles beside each other leave of a sphere: its faces, their moments, and axes for them. Private.
//
// Circles that touch divide the sphere. Arcs run along a circle with the rest of the sphere on their left; at a point
// of contact the boundary goes on along the other circle.

#include <array>
#include <cstdint>
#include <vector>

#include "meso/brep/body.hpp"

namespace meso::brep {

/// A part of a circle on the sphere, in the direction in which the face is on the left: clockwise about `axis`.
struct SphereArc {
  Vec3 axis;         ///< from the sphere's centre through the circle's, unit
  double angle = 0;  ///< between the axis and the circle
  Vec3 from, to;     ///< unit, from the sphere's centre; equal: all of the circle
  bool is_whole = false;
  bool turns_back = false;  ///< ends where another circle touches
  std::uint32_t id = 0;     ///< the caller's
};

/// A circle's arcs in their order, and where each one's boundary goes on: {circle, arc} of the same sphere.
struct SphereCircle {
  std::vector<SphereArc> arcs;
  std::vector<std::array<std::uint32_t, 2>> next;
};

using SphereLoop = std::vector<SphereArc>;

/// The faces, each as its loops; every arc is in one of them. At least one circle.
[[nodiscard]] std::vector<std::vector<SphereLoop>> sphere_faces(const std::vector<SphereCircle>& circles);

/// Of the face on a sphere about `centre`, normals outward.
[[nodiscard]] FaceMoments sphere_moments(Vec3 centre, double radius, const std::vector<SphereLoop>& loops);

/// Axes whose poles and seam (the half circle from pole to pole through x) keep clear of the loops, as well as may be.
/// `hint` is tried first, and is the answer's afterwards.
[[nodiscard]] AxisFrame clear_axes(Vec3 centre, const std::vector<SphereLoop>& loops, AxisFrame& hint);

}  // namespace meso::brep
