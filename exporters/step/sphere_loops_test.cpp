// SPDX-License-Identifier: Apache-2.0
#include "sphere_loops.hpp"

#include <gtest/gtest.h>

namespace meso::step {
namespace {

using namespace brep;

/// Edges between vertices of these numbers; their curves are nothing to loops.
Template edges(const std::vector<std::array<std::uint32_t, 2>>& ends) {
  Template geometry;
  for (const auto& end : ends) geometry.edges.push_back({.curve = Line{}, .vertex = end});
  return geometry;
}

std::vector<std::vector<std::uint32_t>> numbers(const Loops& loops) {
  std::vector<std::vector<std::uint32_t>> out;
  for (const auto& loop : loops) {
    out.emplace_back();
    for (const Coedge& use : loop) out.back().push_back(use.edge);
  }
  return out;
}

using Numbers = std::vector<std::vector<std::uint32_t>>;

TEST(PlainLoops, TouchingLoopsAreApart) {
  const Template geometry = edges({{0, 1}, {1, 2}, {2, 1}, {1, 0}});
  EXPECT_EQ(numbers(plain_loops({.loops = {{{0}, {1}, {2}, {3}}}}, geometry)), (Numbers{{1, 2}, {0, 3}}));
}

TEST(PlainLoops, AVertexOfTheNextCellIsAnother) {
  Template geometry = edges({{0, 0}, {0, 0}});
  geometry.edges[0].vertex_offset[1] = {1, 0, 0};
  geometry.edges[1].vertex_offset[1] = {-1, 0, 0};
  const FaceTemplate face{.loops = {{{.edge = 0}, {.edge = 1, .offset = {1, 0, 0}}}}};
  EXPECT_EQ(numbers(plain_loops(face, geometry)), (Numbers{{0, 1}}));
}

TEST(PlainLoops, SeamsAndPolesGo) {
  Template geometry = edges({{0, 1}, {1, 0}, {1, 2}, {2, 2}});
  geometry.edges[3].degenerate = true;
  // Around a ring that the seam meets, up the seam to the pole, and back.
  const FaceTemplate face{
      .loops = {{{.edge = 0}, {.edge = 2}, {.edge = 3}, {.edge = 2, .reversed = true}, {.edge = 1}}}};
  EXPECT_EQ(numbers(plain_loops(face, geometry)), (Numbers{{0, 1}}));
}

TEST(PlainLoops, ALoopOfNothingButSeamStays) {
  const Template geometry = edges({{0, 1}, {2, 2}});
  const FaceTemplate face{.loops = {{{.edge = 0}, {.edge = 0, .reversed = true}}, {{.edge = 1}}}};
  EXPECT_TRUE(plain_loops(face, geometry).empty());
}

}  // namespace
}  // namespace meso::step
