// SPDX-License-Identifier: Apache-2.0
#pragma once
// Does a surface touch or cross itself?
//
//   const SelfContacts found = count_self_contacts(mesh, chord_heights(mesh));
//   if (found.deep > 0) ...   // more than its chords explain
//
// Counts pairs of triangles that share no point of the mesh and yet have a point in common. Triangles that share a
// point are not tested against each other: where two sheets meet in a whole edge, the edge is used four times, which an
// edge audit tells. Decided in doubles without tolerance: bodies that touch in a point or along a face within rounding
// may go either way.
//
// Triangles are chords. Where two curved faces come close, those of one can pass through those of the other although
// the surfaces keep apart, but no deeper than the two are off their surfaces. A pair is deep if it goes deeper: the
// surfaces themselves cross. How deep is the shortest way along the normal of either triangle that parts the two.
// Cost: about 1 us a triangle for evenly sized triangles, 60 bytes each. Thread rule: pure.

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "meso/base/triangle_stream.hpp"

namespace meso {

struct SelfContacts {
  std::uint64_t pairs = 0;
  std::uint64_t deep = 0;     ///< of those, deeper than the triangles may be off; counting stops at the limit
  double deepest_mm = 0;      ///< of all pairs
  std::optional<Vec3> place;  ///< a corner of the common box of the deepest pair
};

/// Whether pairs that share one point of the mesh are looked at, too: they cross where the edge opposite to it passes
/// through the other. Rounding turns slivers over about their points, so this is for meshes with heights.
enum class SharedPoint { skipped, tested };

/// `heights`: how far each triangle may be off its surface; none: not at all.
[[nodiscard]] SelfContacts count_self_contacts(const TriangleMesh& mesh, std::span<const double> heights = {},
                                               std::uint64_t limit = std::numeric_limits<std::uint64_t>::max(),
                                               SharedPoint shared = SharedPoint::skipped);

/// The deep ones of these pairs, each as its triangles' numbers, up to a limit.
[[nodiscard]] std::vector<std::array<std::uint32_t, 2>> deep_self_contacts(const TriangleMesh& mesh,
                                                                           std::span<const double> heights,
                                                                           std::size_t limit);

/// Whether two triangles have a point in common; decided as above.
[[nodiscard]] bool triangles_meet(const Triangle& s, const Triangle& t);

/// How far each triangle is off a smooth surface through its corners, as the turn from its neighbours tells. Turns of
/// more than a radian are edges of the body.
[[nodiscard]] std::vector<double> chord_heights(const TriangleMesh& mesh);

}  // namespace meso
