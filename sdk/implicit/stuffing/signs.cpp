// SPDX-License-Identifier: Apache-2.0
#include "signs.hpp"

#include "meso/implicit/sampled_row.hpp"

namespace meso::implicit::stuffing {
namespace {

constexpr std::size_t slab_planes = 8;

/// `sign_of(i, j, k)` is what a node is that the solid holds.
template <class Number, class SignOf>
bool sample(const GridSource& source, Points& points, Threads& threads, Number number, SignOf sign_of) {
  const Grid& grid = source.grid();
  return threads.ranges("signs", static_cast<std::size_t>(grid.nodes[2]), slab_planes,
                        [&](std::size_t first, std::size_t last) {
                          const auto sampler = source.sampler();
                          SampledRow row(grid.nodes[0]);
                          sampler->begin_slab(static_cast<std::int32_t>(first), static_cast<std::int32_t>(last));
                          for (auto k = static_cast<std::int32_t>(first); k < static_cast<std::int32_t>(last); ++k)
                            for (std::int32_t j = 0; j < grid.nodes[1]; ++j) {
                              row.sample(*sampler, j, k);
                              for (std::int32_t i = 0; i < grid.nodes[0]; ++i)
                                if (row.inside(i)) points.set_sign(number({i, j, k}), sign_of({i, j, k}));
                            }
                        });
}

}  // namespace

bool sample_signs(Points& points, const GridSource& corners, const GridSource& centres, Threads& threads) {
  const BccLattice& lattice = points.lattice();
  // A point may be beyond the box's maximum along axes where the lattice does not end there.
  const auto within = [&](const Grid& grid, const Index3& i) {
    for (std::size_t a = 0; a < 3; ++a)
      if (grid.coordinate(a, i[a]) >= lattice.box.max[a]) return false;
    return true;
  };
  const auto corner_sign = [&](const Index3& i) {
    bool on_plane = false;
    for (std::size_t a = 0; a < 3; ++a) {
      const bool last = lattice.aligned[a] && i[a] == lattice.cells[a];
      if (!last && lattice.corners.coordinate(a, i[a]) >= lattice.box.max[a]) return Sign::outside;
      on_plane |= last || i[a] == 0;
    }
    return on_plane ? Sign::zero : Sign::inside;
  };
  const auto centre_sign = [&](const Index3& i) { return within(lattice.centres, i) ? Sign::inside : Sign::outside; };
  return sample(
             corners, points, threads, [&](const Index3& i) { return points.corner(i); }, corner_sign) &&
         sample(
             centres, points, threads, [&](const Index3& i) { return points.centre(i); }, centre_sign) &&
         threads.ranges("edges", points.count(), 1 << 14, [&](std::size_t first, std::size_t last) {
           for (std::size_t id = first; id < last; ++id) points.mark_crossings(static_cast<std::uint32_t>(id));
         });
}

}  // namespace meso::implicit::stuffing
