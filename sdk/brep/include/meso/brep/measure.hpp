// SPDX-License-Identifier: Apache-2.0
#pragma once
// Volume, area, centroid and bounding box of a body, from the exact moments of its face templates.
//
//   const Measures m = measure(body);   // m.volume in mm^3
//
// Streams once over the face instances of the outer shells and voids: about 20 ns a face, constant memory. The box
// contains the body; it is the union of the placed boxes of the faces, so it is as tight as those where placements do
// not rotate, and conservative where they do. Thread rule: pure.

#include <cstdint>

#include "meso/brep/body.hpp"

namespace meso::brep {

struct Measures {
  double volume = 0;  ///< mm^3; voids subtracted
  double area = 0;    ///< mm^2; walls of voids included
  Vec3 centroid;      ///< of the volume
  Box3 box;
  std::uint64_t faces = 0, shells = 0, solids = 0;
};

[[nodiscard]] Measures measure(const Body& body);

}  // namespace meso::brep
