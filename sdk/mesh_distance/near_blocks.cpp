// SPDX-License-Identifier: Apache-2.0
#include "near_blocks.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace meso::implicit {
namespace {

using Index = std::array<std::int32_t, 3>;

/// Halves a cube of nodes as long as the surface may be near, down to blocks.
template <class Mark>
class Search {
 public:
  Search(const SignedMesh& mesh, const Grid& grid, const Affine& field_from_grid, double band, Mark mark)
      : mesh_(mesh), grid_(grid), field_from_grid_(field_from_grid), band_(band), mark_(mark) {}

  void visit(Index first, std::int32_t size, std::uint32_t hint) const {
    Box3 box;
    for (std::size_t a = 0; a < 3; ++a) {
      if (first[a] >= grid_.nodes[a]) return;
      box.min[a] = grid_.coordinate(a, first[a]);
      box.max[a] = grid_.coordinate(a, std::min(first[a] + size, grid_.nodes[a]) - 1);
    }
    const Vec3 middle = 0.5 * box.min + 0.5 * box.max, half = box.max - middle;
    double reach = 0;
    for (const Vec3 corner :
         {half, Vec3{-half.x, half.y, half.z}, Vec3{half.x, -half.y, half.z}, Vec3{half.x, half.y, -half.z}})
      reach = std::max(reach, norm(field_from_grid_.linear * corner));
    const double within = (band_ + reach) * (1 + 1e-9);
    const SignedMesh::Value at_middle = mesh_.distance(field_from_grid_ * middle, hint, within);
    if (at_middle.distance > within) return;
    if (size == NearBlocks::edge) return mark_(first);
    const std::int32_t h = size / 2;
    for (int child = 0; child < 8; ++child) {
      visit({first[0] + (child & 1) * h, first[1] + (child >> 1 & 1) * h, first[2] + (child >> 2) * h}, h,
            at_middle.triangle);
    }
  }

 private:
  const SignedMesh& mesh_;
  const Grid& grid_;
  const Affine& field_from_grid_;
  double band_;
  Mark mark_;
};

}  // namespace

NearBlocks::NearBlocks(const SignedMesh& mesh, const Grid& grid, const Affine& field_from_grid, double band,
                       StopPoll& stop) {
  constexpr std::int32_t start = 16 * edge;
  Index roots{};
  for (std::size_t a = 0; a < 3; ++a) {
    blocks_[a] = (grid.nodes[a] + edge - 1) / edge;
    roots[a] = (grid.nodes[a] + start - 1) / start;
  }
  near_.assign(index(0, 0, blocks_[2]), 0);
  const Search search(mesh, grid, field_from_grid, band,
                      [this](Index first) { near_[index(first[0] / edge, first[1] / edge, first[2] / edge)] = 1; });
  tbb::parallel_for(0, roots[0] * roots[1] * roots[2], [&](std::int32_t r) {
    if (stop()) return;
    search.visit({r % roots[0] * start, r / roots[0] % roots[1] * start, r / (roots[0] * roots[1]) * start}, start,
                 TriangleTree::no_triangle);
  });
}

}  // namespace meso::implicit
