// SPDX-License-Identifier: Apache-2.0
#include "sphere_loops.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "meso/brep/instance_map.hpp"

namespace meso::step {

using namespace brep;

VertexKey vertex_of(const Coedge& use, std::size_t end, const Template& geometry) {
  const EdgeTemplate& edge = geometry.edges[use.edge];
  const std::size_t k = use.reversed ? 1 - end : end;
  return {edge.vertex[k], use.offset + edge.vertex_offset[k]};
}

Loops plain_loops(const FaceTemplate& face, const Template& geometry) {
  std::map<std::tuple<std::uint32_t, Index3>, int> uses;
  for (const auto& loop : face.loops)
    for (const Coedge& use : loop) ++uses[{use.edge, use.offset}];
  Loops plain;
  for (const auto& loop : face.loops) {
    const std::size_t before = plain.size();
    std::vector<Coedge> path;  // which every return to one of its vertices shortens by a loop
    for (const Coedge& use : loop) {
      if (geometry.edges[use.edge].degenerate || uses[{use.edge, use.offset}] > 1) continue;
      path.push_back(use);
      const auto first = std::ranges::find_if(
          path, [&](const Coedge& earlier) { return vertex_of(earlier, 0, geometry) == vertex_of(use, 1, geometry); });
      if (first == path.end()) continue;
      plain.emplace_back(first, path.end());
      path.erase(first, path.end());
    }
    if (!path.empty() || plain.size() == before) return {};
  }
  return plain;
}

bool touch(const Loops& loops, const Template& geometry) {
  std::set<VertexKey> passed;
  for (const auto& loop : loops)
    for (const Coedge& use : loop)
      if (!passed.insert(vertex_of(use, 0, geometry)).second) return true;
  return false;
}

}  // namespace meso::step
