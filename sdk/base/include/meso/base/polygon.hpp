// SPDX-License-Identifier: Apache-2.0
#pragma once
// Is a list of corners a polygon with an inside?
//
//   polygon_fault(corners, 1e-6);   // nothing, or "crosses or touches itself (edges 1 and 3)"
//
// Corners in either sense, in any length unit. O(n^2) for n corners.

#include <optional>
#include <span>
#include <string>
#include <utility>

namespace meso {

using Point2 = std::pair<double, double>;

/// What is wrong with the polygon, said of it, or nothing. Corners no farther apart than `least` coincide.
[[nodiscard]] std::optional<std::string> polygon_fault(std::span<const Point2> corners, double least);

/// Do the closed segments ab and cd have a point in common?
[[nodiscard]] bool segments_meet(Point2 a, Point2 b, Point2 c, Point2 d);

/// An odd number of sides crosses the ray to the right. On the boundary either.
[[nodiscard]] bool in_polygon(std::span<const Point2> corners, Point2 p);

/// Positive if the corners run counter-clockwise.
[[nodiscard]] double polygon_area(std::span<const Point2> corners);

}  // namespace meso
