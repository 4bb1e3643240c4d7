// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <tuple>

#include "fill.hpp"

namespace meso::implicit::stuffing {
namespace {

constexpr std::uint8_t on_boundary = 64;  // bits 0-5: in a plane of the box

struct KeyedFace {
  std::array<std::uint32_t, 3> corners;  // ascending
  TetMesh::Face face;
};

std::vector<std::uint8_t> places(const TetMesh& mesh, const Box3& box, const std::vector<bool>& inside) {
  std::vector<std::uint8_t> place(mesh.points.size());
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (inside[i]) continue;
    place[i] = on_boundary;
    for (std::size_t a = 0; a < 3; ++a) {
      if (mesh.points[i][a] == box.min[a]) place[i] |= static_cast<std::uint8_t>(1U << 2 * a);
      if (mesh.points[i][a] == box.max[a]) place[i] |= static_cast<std::uint8_t>(2U << 2 * a);
    }
  }
  return place;
}

}  // namespace

void find_boundary(Numbered& numbered, const Box3& box) {
  TetMesh& mesh = numbered.mesh;
  const std::vector<std::uint8_t> place = places(mesh, box, numbered.inside);
  std::vector<KeyedFace> candidates;
  for (std::uint32_t t = 0; t < mesh.tets.size(); ++t)
    for (std::uint8_t f = 0; f < 4; ++f) {
      TetMesh::Face face{t, f, TetMesh::Side::surface};
      auto corners = mesh.corners(face);
      const std::uint8_t shared = place[corners[0]] & place[corners[1]] & place[corners[2]];
      if (shared == 0) continue;
      if (const unsigned planes = shared & (on_boundary - 1U); planes != 0) {
        face.side = static_cast<TetMesh::Side>(std::countr_zero(planes));
        mesh.boundary.push_back(face);  // nothing is beyond the box
        continue;
      }
      std::sort(corners.begin(), corners.end());
      candidates.push_back({corners, face});
    }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const KeyedFace& a, const KeyedFace& b) { return a.corners < b.corners; });
  for (std::size_t i = 0; i < candidates.size();) {
    const bool twice = i + 1 < candidates.size() && candidates[i + 1].corners == candidates[i].corners;
    if (!twice) mesh.boundary.push_back(candidates[i].face);
    i += twice ? 2 : 1;
  }
  std::sort(mesh.boundary.begin(), mesh.boundary.end(), [](const TetMesh::Face& a, const TetMesh::Face& b) {
    return std::tuple(a.side, a.tet, a.face) < std::tuple(b.side, b.tet, b.face);
  });
}

}  // namespace meso::implicit::stuffing
