// SPDX-License-Identifier: Apache-2.0
#pragma once
// Triangles of a curved face between the points of its border, in a plane that its surface is unrolled to. Private.
//
//   const auto mesh = unrolled_mesh(surface, {{{{1, 0, 0}, {0, 0}}, ...}});
//   if (mesh && mesh->fold == 0) ...
//
// OpenCASCADE's mesher leaves points of the border out, or all triangles, where a face is narrower than the chords of
// its edges are off. Here no point is left out and none is added; what is farther from the surface than it may be, is
// for fit_triangles(). A cylinder and a cone are unrolled, so that lengths stay; of other surfaces the parameters are
// scaled. Thread rule: pure.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "occt.hpp"
#include "plane_mesh.hpp"

namespace meso::brep {

struct BorderPoint {
  Vec3 point;
  PlanePoint at{};  ///< its parameters on the surface, without leaps along a loop
};
/// With the face on the left, seen against du x dv.
using BorderLoop = std::vector<BorderPoint>;

/// How high the highest triangle is that lies the wrong way about (clockwise seen against du x dv), in millimetres
/// along the surface. Chords that keep apart in the parameters may pass each other in space.
[[nodiscard]] double fold_of(const Handle(Geom_Surface) & surface, std::span<const BorderPoint> points,
                             std::span<const std::array<std::uint32_t, 3>> triangles);

struct UnrolledMesh {
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise; points are counted through all loops
  double fold = 0;
};

/// Polygons that cross each other, as chords of a crescent do near its tips, have no triangles without a fold; then
/// those that are folded least. Empty where a loop has too many points for that.
[[nodiscard]] std::optional<UnrolledMesh> unrolled_mesh(const Handle(Geom_Surface) & surface,
                                                        const std::vector<BorderLoop>& loops);

}  // namespace meso::brep
