// SPDX-License-Identifier: Apache-2.0
#pragma once
// What circles beside each other leave of a sphere: its faces, their moments, and axes for them. Private.
//
// Circles that touch divide the sphere, and so do cuts, arcs of great circles between them. Arcs run along a circle
// with the rest of the sphere on their left; at a point of contact the boundary goes on along the other circle, at a
// cut along the cut.

#include <array>
#include <cstdint>
#include <vector>

#include "meso/brep/body.hpp"

namespace meso::brep {

/// A part of a circle on the sphere, in the direction in which the face is on the left: clockwise about `axis`. Of a
/// cut the angle is a right one.
struct SphereArc {
  Vec3 axis;         ///< from the sphere's centre through the circle's, unit
  double angle = 0;  ///< between the axis and the circle
  Vec3 from, to;     ///< unit, from the sphere's centre; equal: all of the circle
  bool is_whole = false;
  std::uint32_t id = 0;  ///< the caller's
};

/// A circle's arcs in their order, or the two sides of a cut, and where each one's boundary goes on: {circle, arc} of
/// the same sphere.
struct SphereCircle {
  std::vector<SphereArc> arcs;
  std::vector<std::array<std::uint32_t, 2>> next;
};

using SphereLoop = std::vector<SphereArc>;

/// The faces, each as its loops; every arc is in one of them. At least one circle.
[[nodiscard]] std::vector<std::vector<SphereLoop>> sphere_faces(const std::vector<SphereCircle>& circles);

/// Of the face on a sphere about `centre`, normals outward.
[[nodiscard]] FaceMoments sphere_moments(Vec3 centre, double radius, const std::vector<SphereLoop>& loops);

/// How far the boundary turns to the left from the end of one arc to the beginning of the other, above -pi to pi.
[[nodiscard]] double turn_between(const SphereArc& arc, const SphereArc& next);

/// Axes whose poles and seam (the half circle from pole to pole through x) keep clear of the loops, as well as may be.
/// `hint` is tried first, and is the answer's afterwards.
[[nodiscard]] AxisFrame clear_axes(Vec3 centre, const std::vector<SphereLoop>& loops, AxisFrame& hint);

/// Axes with poles and seam on the side across, of a face in one half of the sphere.
[[nodiscard]] AxisFrame axes_across(Vec3 centre, const SphereLoop& loop);

}  // namespace meso::brep
