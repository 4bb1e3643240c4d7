// SPDX-License-Identifier: Apache-2.0
#pragma once
// Triangles between polygons in a plane, by constrained Delaunay triangulation. Private.
//
//   auto triangles = triangulate_between({{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {{0, 1, 2, 3}});
//
// A plate with a thousand holes is one face with a thousand circles; OpenCASCADE's mesher takes time quadratic in them.
// This takes 2 us a point. Points are inserted along a space-filling curve, each found by a walk from the last
// (Lawson's flips restore the circles); edges that are missing are put in by flips (Sloan, Adv. Eng. Software 15,
// 1993). Predicates are exact: points are rounded to 2^-28 of the region's size and compared as integers. Thread rule:
// pure.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace meso::brep {

using PlanePoint = std::array<double, 2>;

/// Counter-clockwise triangles that cover what an odd number of loops goes round. No point is added, each side of a
/// loop is a side of a triangle. Empty if loops cross, or come so close that rounding makes them meet.
[[nodiscard]] std::optional<std::vector<std::array<std::uint32_t, 3>>> triangulate_between(
    std::span<const PlanePoint> points, std::span<const std::vector<std::uint32_t>> loops);

}  // namespace meso::brep
