// SPDX-License-Identifier: Apache-2.0
#pragma once
// What remains of a tetrahedron of the lattice whose corners are inside, outside or on the surface. Private.
//
// A lattice tetrahedron has two long edges: between its corners 0 and 1, which belong to one of the two cubic lattices,
// and between 2 and 3, which belong to the other. Its local nodes are the four corners and, 4 to 9, the places where
// the surface cuts an edge (edge_node).

#include <array>
#include <cstddef>
#include <cstdint>

namespace meso::implicit::stuffing {

enum class Sign : std::uint8_t { outside, zero, inside };

using LocalTet = std::array<std::uint8_t, 4>;  ///< local nodes, positively oriented

struct Stencil {
  std::uint8_t count = 0;
  std::array<LocalTet, 3> tets{};
};

/// The node on the edge between two different corners.
[[nodiscard]] constexpr std::uint8_t edge_node(std::size_t a, std::size_t b) {
  constexpr std::array<std::array<std::uint8_t, 4>, 4> node{{{0, 4, 5, 6}, {4, 1, 7, 8}, {5, 7, 2, 9}, {6, 8, 9, 3}}};
  return node[a][b];
}

/// `even`: an even number of the coordinates of corner 0 are greater than those of corner 2. It decides between the
/// diagonals of quadrilaterals that have none better, the same way in both tetrahedra that share one.
[[nodiscard]] const Stencil& stencil(const std::array<Sign, 4>& signs, bool even);

}  // namespace meso::implicit::stuffing
