// SPDX-License-Identifier: Apache-2.0
#pragma once
// On which side of a line, of a plane? Decided exactly for doubles between 1e-60 and 1e60: a rounded value where its
// error bound allows, sums without rounding otherwise (Shewchuk, Adaptive precision floating-point arithmetic, 1997).

#include "meso/base/triangle_stream.hpp"

namespace meso::implicit {

struct Point2 {
  double u, v;
};

/// Sign of the area of a b p: 1 if they turn counter-clockwise, 0 if they lie on one line.
[[nodiscard]] int turn_sign(Point2 a, Point2 b, Point2 p);

/// 1 if p is on the side that the triangle's normal points to, 0 if it is in its plane or the triangle has no area.
[[nodiscard]] int side_sign(const Triangle& t, Vec3 p);

/// Is p in the closed triangle, which may be a segment or a point?
[[nodiscard]] bool is_on(const Triangle& t, Vec3 p);

/// The triangle as a ray in the direction of x sees it. A ray through an edge or a corner would have no answer, so the
/// ray of p stands for the one at (y + e, z + e^2) with e as small as one likes (Edelsbrunner, Muecke: Simulation of
/// simplicity, 1990): what is closed is entered as often as it is left on every ray.
struct RayView {
  int crossing = 0;      ///< 1: the ray leaves through the triangle, -1: it enters, 0: it passes by
  bool touches = false;  ///< the ray itself meets the closed triangle's outline
};
[[nodiscard]] RayView view_along_x(const Triangle& t, double y, double z);

}  // namespace meso::implicit
