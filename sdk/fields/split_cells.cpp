// SPDX-License-Identifier: Apache-2.0
#include "meso/fields/split_cells.hpp"

#include <algorithm>
#include <array>
#include <cassert>

namespace meso::fields {
namespace {

using Side = std::array<int, 4>;  // around it; the last is -1 where there are three
constexpr std::array<Side, 5> pyramid_sides{{{0, 1, 2, 3}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}}};
constexpr std::array<Side, 5> wedge_sides{{{0, 1, 2, -1}, {3, 4, 5, -1}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}};
constexpr std::array<Side, 6> hexahedron_sides{
    {{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};

std::span<const Side> sides_of(CellKind kind) {
  if (kind == CellKind::pyramid) return pyramid_sides;
  if (kind == CellKind::wedge) return wedge_sides;
  return hexahedron_sides;
}

}  // namespace

std::size_t corners_of(CellKind kind) { return kind == CellKind::pyramid ? 5 : kind == CellKind::wedge ? 6 : 8; }

void append_tetrahedra(CellKind kind, std::span<const std::int64_t> corners, std::vector<std::int64_t>& tetra) {
  assert(corners.size() == corners_of(kind));
  const std::int64_t lowest = *std::min_element(corners.begin(), corners.end());
  for (const Side& side : sides_of(kind)) {
    std::array<std::int64_t, 4> around{};
    const std::size_t size = side[3] < 0 ? 3 : 4;
    for (std::size_t i = 0; i < size; ++i) around[i] = corners[static_cast<std::size_t>(side[i])];
    std::rotate(around.begin(), std::min_element(around.begin(), around.begin() + size), around.begin() + size);
    if (around[0] == lowest) continue;
    for (std::size_t i = 2; i < size; ++i) tetra.insert(tetra.end(), {lowest, around[0], around[i - 1], around[i]});
  }
}

}  // namespace meso::fields
