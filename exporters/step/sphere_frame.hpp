// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where the poles and the seam of a sphere are is nothing to STEP, but OpenCASCADE's reader divides every edge that its
// seam crosses, and in lattices whose balls have many struts not always in both faces: the shell then stays open.

#include "meso/brep/body.hpp"

namespace meso::step {

/// Of each loop, in order: unit vectors from the centre, near enough to each other to keep clear of the line.
[[nodiscard]] std::vector<std::vector<Vec3>> points_of_loops(const brep::FaceTemplate& face,
                                                             const brep::Template& geometry, Vec3 centre);

/// Axes for the sphere under `face` with poles and seam as clear of its loops as can be found: no loop crosses the
/// seam, but once where it is around a pole. The sphere's own if they are clear, or if the face has an edge along its
/// seam. Cost: some milliseconds where they are not.
[[nodiscard]] brep::AxisFrame clear_frame(const brep::SphereSurface& sphere, const brep::FaceTemplate& face,
                                          const brep::Template& geometry);

}  // namespace meso::step
