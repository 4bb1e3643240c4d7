// SPDX-License-Identifier: Apache-2.0
#pragma once
// Is every shell of a body closed and oriented? Decided by counting, from the topology alone.
//
//   const Audit a = audit(body);
//   if (!a.clean()) ...
//
// In a closed oriented shell every edge that has a curve is used twice, once in each direction. About 0.1 us and 16 to
// 40 bytes an edge, one shell at a time. Thread rule: pure.

#include <cstdint>

#include "meso/brep/body.hpp"

namespace meso::brep {

struct Audit {
  std::uint64_t faces = 0, edges = 0, shells = 0;
  std::uint64_t components = 0;  ///< sets of faces connected by edges; as many as shells when every shell is one piece
  std::uint64_t free_edges = 0;  ///< used once: a hole
  std::uint64_t multiple_edges = 0;  ///< used more than twice: not a manifold
  std::uint64_t conflicts = 0;       ///< used twice in the same direction: normals disagree
  std::uint64_t open_loops = 0;      ///< loops whose edges do not chain end to start
  std::uint64_t missing_faces = 0;   ///< instances of a face the template has not

  [[nodiscard]] bool clean() const {
    return free_edges + multiple_edges + conflicts + open_loops + missing_faces == 0 && components == shells;
  }
};

[[nodiscard]] Audit audit(const Body& body);

}  // namespace meso::brep
