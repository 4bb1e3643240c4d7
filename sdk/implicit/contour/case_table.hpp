// SPDX-License-Identifier: Apache-2.0
#pragma once
// The triangles of every cell, made by program: which corners are inside and which faces join them decide everything.
//
// Corners 0...7 count x first, then y, then z. Edges: 0...3 along x at (y, z) = (0,0) (1,0) (0,1) (1,1); 4...7 along y
// at (x, z) in the same order; 8...11 along z at (x, y) likewise. Faces: 0 1 across x, 2 3 across y, 4 5 across z.
// An ambiguous face (its diagonals agree, its sides do not) separates its inside corners unless its bit in `joined` is
// set.
//
// A loop of crossed edges is triangulated without diagonals that lie in a face of the cell: only then is every edge of
// the mesh in exactly two triangles, because a diagonal belongs to one cell, and a line in a face to the two cells of
// that face. A loop that has no such triangulation gets a vertex in its middle.

#include <array>
#include <cstdint>
#include <vector>

namespace meso::implicit {

inline constexpr std::array<std::array<std::uint8_t, 2>, 12> edge_corners{
    {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};
/// Counter-clockwise seen from outside of the cell.
inline constexpr std::array<std::array<std::uint8_t, 4>, 6> face_corners{
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

inline constexpr std::uint8_t centre_vertex = 12;

/// The triangles of one cell as edges, or centre_vertex.
struct CellTriangles {
  std::uint8_t count = 0;
  std::uint16_t centre_edges = 0;  ///< bit set of the loop whose middle is the centre vertex; 0: there is none
  std::array<std::array<std::uint8_t, 3>, 12> triangles{};
};

/// A closed line of crossed edges around a part of the surface, and the triangles of that part.
struct CellLoop {
  std::uint8_t size = 0, first_triangle = 0, triangle_count = 0;
  bool has_centre = false;
  std::array<std::uint8_t, 12> edges{};  ///< consecutive ones share a face
};
struct CellLoops {
  std::uint8_t count = 0;
  std::array<CellLoop, 4> loops{};
};

/// What the fast path reads: cells without joined faces. Five triangles are always written, `count` of them are meant.
struct PlainCell {
  std::array<std::array<std::uint8_t, 3>, 5> triangles{};
  std::uint8_t count = 0;
};

class CaseTable {
 public:
  /// Made once, in less than a millisecond.
  [[nodiscard]] static const CaseTable& get();

  [[nodiscard]] const PlainCell& plain(unsigned inside) const { return plain_[inside]; }
  [[nodiscard]] std::uint8_t ambiguous_faces(unsigned inside) const { return ambiguous_[inside]; }
  /// Bits of `joined` count for ambiguous faces only.
  [[nodiscard]] const CellTriangles& at(unsigned inside, unsigned joined) const {
    return cells_[slot_[64 * inside + (joined & ambiguous_[inside])]];
  }
  [[nodiscard]] const CellLoops& loops(unsigned inside, unsigned joined) const {
    return loops_[slot_[64 * inside + (joined & ambiguous_[inside])]];
  }
  /// The face that two edges of a cell have in common; they have one.
  [[nodiscard]] std::uint8_t common_face(std::uint8_t a, std::uint8_t b) const { return common_face_[a][b]; }
  /// Bit set.
  [[nodiscard]] std::uint16_t edges_of_face(unsigned face) const { return edges_of_face_[face]; }
  /// An edge of a face across `axis`, as the cell on the other side of that face counts it.
  [[nodiscard]] std::uint8_t mirrored(std::uint8_t edge, unsigned axis) const { return mirrored_[edge][axis]; }

 private:
  CaseTable();

  std::array<PlainCell, 256> plain_{};
  std::array<std::uint8_t, 256> ambiguous_{};
  std::array<std::uint16_t, 256 * 64> slot_{};
  std::vector<CellTriangles> cells_;
  std::vector<CellLoops> loops_;
  std::array<std::array<std::uint8_t, 12>, 12> common_face_{};
  std::array<std::array<std::uint8_t, 3>, 12> mirrored_{};
  std::array<std::uint16_t, 6> edges_of_face_{};
};

}  // namespace meso::implicit
