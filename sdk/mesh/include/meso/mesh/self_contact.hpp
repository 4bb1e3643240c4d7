// SPDX-License-Identifier: Apache-2.0
#pragma once
// Does a surface touch or cross itself?
//
//   if (count_self_contacts(mesh).pairs > 0) ...
//
// Counts pairs of triangles that share no point of the mesh and yet have a point in common. Triangles that share a
// point are not tested against each other: where two sheets meet in a whole edge, the edge is used four times, which an
// edge audit tells. Decided in doubles without tolerance: bodies that touch in a point or along a face within rounding
// may go either way. Cost: about 1 us a triangle for evenly sized triangles, 40 bytes each. Thread rule: pure.

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "meso/base/triangle_mesh.hpp"

namespace meso {

struct SelfContacts {
  std::uint64_t pairs = 0;          ///< stops counting at the limit
  std::optional<Vec3> first_place;  ///< a corner of the first pair's common box
};

[[nodiscard]] SelfContacts count_self_contacts(const TriangleMesh& mesh,
                                               std::uint64_t limit = std::numeric_limits<std::uint64_t>::max());

/// The triangles of all pairs, ascending.
[[nodiscard]] std::vector<std::uint32_t> triangles_in_contact(const TriangleMesh& mesh);

}  // namespace meso
