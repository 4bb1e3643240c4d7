// SPDX-License-Identifier: Apache-2.0
#include "case_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <utility>

namespace meso::implicit {
namespace {

bool inside_at(unsigned inside, unsigned corner) { return (inside >> corner & 1U) != 0; }

bool crossed(unsigned inside, unsigned edge) {
  return inside_at(inside, edge_corners[edge][0]) != inside_at(inside, edge_corners[edge][1]);
}

unsigned common_faces(unsigned a, unsigned b) {
  unsigned count = 0;
  for (const auto& face : face_corners) {
    unsigned corners = 0;
    for (const unsigned c : face)
      for (const unsigned e : {a, b}) corners += c == edge_corners[e][0] || c == edge_corners[e][1] ? 1 : 0;
    count += corners == 4 ? 1 : 0;
  }
  return count;
}

template <class Visit>
void visit_cells(Visit visit) {
  const CaseTable& table = CaseTable::get();
  for (unsigned inside = 0; inside < 256; ++inside)
    for (unsigned joined = 0; joined < 64; ++joined)
      if ((joined & ~unsigned{table.ambiguous_faces(inside)}) == 0) visit(inside, joined, table.at(inside, joined));
}

// Sides of triangles that no other triangle of the cell runs through in the other direction.
std::map<std::pair<unsigned, unsigned>, int> border(const CellTriangles& cell) {
  std::map<std::pair<unsigned, unsigned>, int> sides;
  for (unsigned t = 0; t < cell.count; ++t)
    for (unsigned i = 0; i < 3; ++i) {
      const unsigned a = cell.triangles[t][i], b = cell.triangles[t][(i + 1) % 3];
      if (const auto back = sides.find({b, a}); back != sides.end())
        sides.erase(back);
      else
        ++sides[{a, b}];
    }
  return sides;
}

TEST(CaseTable, LeavesLinesInFacesOnly) {
  visit_cells([](unsigned inside, unsigned joined, const CellTriangles& cell) {
    std::array<int, 12> begins{}, ends{};
    for (const auto& [side, count] : border(cell)) {
      ASSERT_EQ(count, 1) << inside << ' ' << joined;
      ASSERT_LT(std::max(side.first, side.second), 12u);
      EXPECT_GT(common_faces(side.first, side.second), 0u) << inside << ' ' << joined;
      ++begins[side.first];
      ++ends[side.second];
    }
    for (unsigned e = 0; e < 12; ++e) {
      EXPECT_EQ(begins[e], crossed(inside, e) ? 1 : 0) << inside << ' ' << joined;
      EXPECT_EQ(ends[e], crossed(inside, e) ? 1 : 0) << inside << ' ' << joined;
    }
  });
}

TEST(CaseTable, HasNoDiagonalInAFace) {
  visit_cells([](unsigned inside, unsigned joined, const CellTriangles& cell) {
    const auto lines = border(cell);
    for (unsigned t = 0; t < cell.count; ++t)
      for (unsigned i = 0; i < 3; ++i) {
        const unsigned a = cell.triangles[t][i], b = cell.triangles[t][(i + 1) % 3];
        if (a == centre_vertex || b == centre_vertex || lines.contains({a, b})) continue;
        EXPECT_EQ(common_faces(a, b), 0u) << inside << ' ' << joined;
      }
  });
}

TEST(CaseTable, SeparatesOrJoinsTheCornersOfAFace) {
  // Corners 0 and 3 of the face z = 0: two triangles, or a band whose four sides in the face cross over.
  const CaseTable& table = CaseTable::get();
  EXPECT_EQ(table.ambiguous_faces(0b1001), 1U << 4);
  EXPECT_EQ(table.at(0b1001, 0).count, 2);
  EXPECT_EQ(table.at(0b1001, 1U << 4).count, 4);
}

TEST(CaseTable, FacesOutward) {
  // One corner inside: seen from the far corner, x, y, z turn counter-clockwise.
  const auto& t = CaseTable::get().plain(1).triangles[0];
  const std::array<std::uint8_t, 3> edges{t[0], t[1], t[2]};
  EXPECT_TRUE((edges == std::array<std::uint8_t, 3>{0, 4, 8}) || (edges == std::array<std::uint8_t, 3>{4, 8, 0}) ||
              (edges == std::array<std::uint8_t, 3>{8, 0, 4}));
}

}  // namespace
}  // namespace meso::implicit
