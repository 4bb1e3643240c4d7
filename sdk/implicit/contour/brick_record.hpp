// SPDX-License-Identifier: Apache-2.0
#pragma once
// All that the second pass needs to know of a brick: signs as run lengths, how many vertices each row has, the few
// cells whose faces join, and those with sharp edges. 8 bytes a row and 2 a crossing, or a bit a node where that is
// less.

#include <bit>
#include <cstring>
#include <span>
#include <tuple>
#include <vector>

#include "layout.hpp"
#include "meso/base/vec.hpp"

namespace meso::implicit {

/// Vertices of a row, in the order in which they are numbered: edges along x, then y (from the row before), then z
/// (from the plane below), then vertices in the middle of cells.
struct RowCounts {
  std::uint16_t x = 0, y = 0, z = 0, centre = 0;
  [[nodiscard]] std::uint32_t total() const { return std::uint32_t{x} + y + z + centre; }
};

/// A cell with faces that join its inside corners.
struct JoinedCell {
  std::uint32_t row = 0;  ///< (k - first plane of the brick) * (rows + 1) + j
  std::uint16_t cell = 0;
  std::uint8_t joined = 0;
};

/// A vertex on a sharp edge or corner of the solid, in the middle of one loop of a cell.
struct Feature {
  std::uint32_t row = 0;  ///< as of JoinedCell
  std::uint16_t cell = 0;
  std::uint16_t edges = 0;   ///< bit set: those of the loop
  std::uint8_t faces = 0;    ///< bit set: through which the sharp edge goes on
  std::uint32_t vertex = 0;  ///< counted from the brick's first
};

/// Where a feature's sharp edge goes on into another brick: a side of its loop, and the feature.
struct BorderSide {
  std::uint32_t row = 0;  ///< of the feature
  std::uint16_t cell = 0;
  std::uint8_t edge = 0, next = 0;  ///< of the cell: between these the side runs
  Vec3 vertex, from, normal;        ///< the feature's; the point on `edge`, and the field's normal there
  [[nodiscard]] auto place() const { return std::tuple(row, cell, edge); }
};

/// Whether two features on both sides of a face between bricks may be joined: not if that turns a triangle, and the
/// side between them does not.
[[nodiscard]] bool joins_well(const BorderSide& lower, const BorderSide& upper, double least);

struct BrickRecord {
  std::vector<std::uint16_t> signs;  ///< row after row: RowCounts, then crossings or words
  std::size_t last_plane = 0;        ///< where in `signs` it begins
  std::uint64_t vertices = 0;
  std::uint64_t last_plane_vertices = 0;
  std::uint64_t undefined = 0;
  std::uint64_t inside = 0;  ///< nodes
  std::vector<JoinedCell> joined;
  std::vector<Feature> features;    ///< by row, cell and loop
  std::vector<BorderSide> borders;  ///< by place

  [[nodiscard]] std::uint64_t bytes() const {
    return signs.capacity() * sizeof signs[0] + joined.capacity() * sizeof joined[0] +
           features.capacity() * sizeof features[0] + borders.capacity() * sizeof borders[0];
  }
};

/// Whether a row's signs are kept as crossings, and not as words.
[[nodiscard]] inline bool kept_as_crossings(std::size_t crossings, std::size_t words) { return crossings <= 4 * words; }

inline void append_row(std::vector<std::uint16_t>& signs, RowCounts counts, const std::uint16_t* crossings,
                       const std::uint64_t* inside, std::size_t words) {
  signs.insert(signs.end(), {counts.x, counts.y, counts.z, counts.centre});
  if (kept_as_crossings(counts.x, words)) {
    signs.insert(signs.end(), crossings, crossings + counts.x);
  } else {
    const std::size_t old = signs.size();
    signs.resize(old + 4 * words);
    std::memcpy(signs.data() + old, inside, words * sizeof *inside);
  }
}

/// Reads the row at `from` into `inside` and moves on to the next.
inline RowCounts read_row(const std::uint16_t*& from, std::uint64_t* inside, std::size_t words) {
  const RowCounts counts{from[0], from[1], from[2], from[3]};
  from += 4;
  if (!kept_as_crossings(counts.x, words)) {
    std::memcpy(inside, from, words * sizeof *inside);
    from += 4 * words;
    return counts;
  }
  std::memset(inside, 0, words * sizeof *inside);
  if (counts.x == 0) return counts;
  for (std::size_t c = 0; c < counts.x; ++c) inside[from[c] / 64] |= std::uint64_t{1} << from[c] % 64;
  from += counts.x;
  // Between an odd crossing and the next lies the inside: the parity of all crossings so far.
  std::uint64_t carry = 0;
  for (std::size_t w = 0; w < words; ++w) {
    std::uint64_t parity = inside[w];
    parity ^= parity << 1;
    parity ^= parity << 2;
    parity ^= parity << 4;
    parity ^= parity << 8;
    parity ^= parity << 16;
    parity ^= parity << 32;
    inside[w] = parity ^ carry;
    carry ^= std::uint64_t{0} - (parity >> 63);
  }
  return counts;
}

}  // namespace meso::implicit
