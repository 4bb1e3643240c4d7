// SPDX-License-Identifier: Apache-2.0
#include "meso/brep/audit.hpp"

#include <algorithm>
#include <numeric>

#include "meso/brep/instance_map.hpp"

namespace meso::brep {
namespace {

struct EdgeUses {
  std::uint32_t first_face = 0;
  std::uint16_t forward = 0, backward = 0;
};

class Components {
 public:
  std::uint32_t add() {
    parent_.push_back(static_cast<std::uint32_t>(parent_.size()));
    return parent_.back();
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[root(a)] = root(b); }
  [[nodiscard]] std::uint64_t count() const {
    std::uint64_t roots = 0;
    for (std::uint32_t i = 0; i < parent_.size(); ++i) roots += parent_[i] == i;
    return roots;
  }

 private:
  std::uint32_t root(std::uint32_t a) {
    while (parent_[a] != a) a = parent_[a] = parent_[parent_[a]];
    return a;
  }
  std::vector<std::uint32_t> parent_;
};

// The vertex, with its cell relative to the face's, at the start (0) or end (1) of a coedge.
std::pair<std::uint32_t, Index3> end_of(const Template& geometry, const Coedge& use, std::size_t end) {
  const EdgeTemplate& edge = geometry.edges[use.edge];
  const std::size_t k = use.reversed ? 1 - end : end;
  return {edge.vertex[k], use.offset + edge.vertex_offset[k]};
}

bool is_chain(const Template& geometry, const std::vector<Coedge>& loop) {
  for (std::size_t i = 0; i < loop.size(); ++i)
    if (end_of(geometry, loop[i], 1) != end_of(geometry, loop[(i + 1) % loop.size()], 0)) return false;
  return !loop.empty();
}

// Loops are the same in every cell: judged once per template face.
std::vector<std::uint32_t> open_loops_per_face(const Template& geometry) {
  std::vector<std::uint32_t> open;
  for (const FaceTemplate& face : geometry.faces)
    open.push_back(static_cast<std::uint32_t>(std::count_if(
        face.loops.begin(), face.loops.end(), [&](const auto& loop) { return !is_chain(geometry, loop); })));
  return open;
}

void audit_shell(const Shell& shell, Audit& result) {
  const Template& geometry = *shell.geometry;
  const std::vector<std::uint32_t> open_loops = open_loops_per_face(geometry);
  InstanceMap<EdgeUses> edges;
  Components components;
  shell.visit([&](const FaceInstance& instance) {
    if (instance.face >= geometry.faces.size()) {
      ++result.missing_faces;
      return;
    }
    const std::uint32_t face = components.add();
    result.open_loops += open_loops[instance.face];
    for (const auto& loop : geometry.faces[instance.face].loops)
      for (const Coedge& use : loop) {
        if (geometry.edges[use.edge].degenerate) continue;
        const auto [uses, fresh] = edges.find_or_add(use.edge, instance.cell + use.offset);
        if (fresh)
          uses.first_face = face;
        else
          components.join(face, uses.first_face);
        std::uint16_t& count = use.reversed ? uses.backward : uses.forward;
        if (count < 0xffff) ++count;
      }
    ++result.faces;
  });
  edges.visit_values([&](const EdgeUses& uses) {
    const int count = uses.forward + uses.backward;
    result.free_edges += count == 1;
    result.multiple_edges += count > 2;
    result.conflicts += count == 2 && uses.forward != 1;
  });
  result.edges += edges.size();
  result.components += components.count();
  ++result.shells;
}

}  // namespace

Audit audit(const Body& body) {
  Audit result;
  for (const Solid& solid : body.solids) {
    audit_shell(solid.outer, result);
    for (const Shell& hollow : solid.voids) audit_shell(hollow, result);
  }
  return result;
}

}  // namespace meso::brep
