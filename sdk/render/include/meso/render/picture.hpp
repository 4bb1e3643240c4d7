// SPDX-License-Identifier: Apache-2.0
#pragma once
// One well-lit picture of a triangle mesh, by ray casting, without a display.
//
//   DiagnosticSink sink;
//   if (auto image = picture::draw(mesh, {}, {}, sink)) file << picture::png(*image);
//
// The camera fits itself around the mesh: a three-quarter view with mild perspective. Facets that meet at less than
// 40 degrees are shaded as one smooth surface, so a coarse tessellation of a cylinder looks round. Equal input gives
// equal bytes on one kind of processor, for any number of threads.
//
// Units: millimetres and radians; all points must be finite (not checked). Errors: RENDER_NOTHING (no triangle with an
// area), RENDER_MEMORY (Embree's tree does not fit), CANCELLED. Cost at 1200 x 900 on two cores: 1.1 s for a box, 8 s
// and 0.7 GiB for a truss of 2.9 million triangles. Thread rule: draw() may run in several threads at once; it spreads
// over RunOptions::jobs threads of its own.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/base/triangle_mesh.hpp"

namespace meso::picture {

/// Which axis points up in the picture. `automatic` is z, except for parts more than twice as tall as they are wide:
/// those lie down, y up.
enum class Up { automatic, x, y, z };

/// The part is cut by the plane where the coordinate `axis` (0, 1, 2 = x, y, z) is `position` millimetres; the half
/// towards the viewer is taken away and the section drawn in a colour of its own. The mesh must be closed.
struct Cut {
  std::size_t axis = 0;
  double position = 0;
};

struct RenderOptions {
  std::uint32_t width = 1200, height = 900;  ///< pixels, 1 ... 16384
  Up up = Up::automatic;
  double azimuth = 0.62;    ///< where the viewer stands: with z up, 0 is at -y and pi/2 at +x (cyclic for other ups)
  double elevation = 0.46;  ///< viewer's height above the horizon, in (-pi/2, pi/2)
  std::optional<Cut> cut{};
  std::uint32_t samples = 2;  ///< 1 ... 8: n x n rays a pixel, each followed by five towards the light; 4 for print
};

/// 8-bit sRGB, row by row from the top, three bytes a pixel.
struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

[[nodiscard]] std::optional<Image> draw(const TriangleMesh& mesh, const RenderOptions& options, const RunOptions& run,
                                        DiagnosticSink& sink);

/// The image as the bytes of a PNG file; no date, no program name. Empty only if libpng refuses (out of memory).
[[nodiscard]] std::string png(const Image& image);

}  // namespace meso::picture
