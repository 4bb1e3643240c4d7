// SPDX-License-Identifier: Apache-2.0
#include "lattice.hpp"

#include <algorithm>
#include <cmath>

namespace meso::implicit {
namespace {

constexpr double nearly_whole = 1e-9;

bool is_whole(double cells) { return std::abs(cells - std::round(cells)) <= nearly_whole * cells; }

/// Cells along the box's longest side.
double cells_along(const Vec3& size, double longest, double spacing) {
  const double wanted = std::max(2.0, std::round(longest / spacing));
  const double slack = std::max(1.0, std::floor(0.03 * wanted));
  for (double off = 0; off <= slack; ++off)
    for (const double n : {wanted + off, wanted - off})
      if (n >= 2 && is_whole(size.x * n / longest) && is_whole(size.y * n / longest) && is_whole(size.z * n / longest))
        return n;
  return wanted;
}

}  // namespace

BccLattice bcc_lattice(const Box3& box, double spacing) {
  const Vec3 size = box.max - box.min;
  const double longest = std::max({size.x, size.y, size.z});
  BccLattice lattice{.box = box};
  lattice.spacing = longest / cells_along(size, longest, spacing);
  lattice.corners.box = lattice.centres.box = box;
  for (std::size_t a = 0; a < 3; ++a) {
    const double h = lattice.spacing, cells = size[a] / h;
    lattice.aligned[a] = is_whole(cells) && std::round(cells) >= 2;
    const double whole = lattice.aligned[a] ? std::round(cells) : std::max(2.0, std::ceil(cells));
    lattice.cells[a] = static_cast<std::int32_t>(std::min(whole, 1e9));
    lattice.corners.nodes[a] = lattice.cells[a] + 1;
    lattice.centres.nodes[a] = lattice.cells[a];
    if (!lattice.aligned[a]) lattice.corners.box.max[a] = box.min[a] + whole * h;
    lattice.centres.box.min[a] = box.min[a] + 0.5 * h;
    lattice.centres.box.max[a] = box.min[a] + (whole - 0.5) * h;
  }
  return lattice;
}

namespace stuffing {

std::uint64_t point_count(const BccLattice& lattice) {
  std::uint64_t corners = 1, centres = 1;
  for (const std::int32_t n : lattice.cells) {
    corners *= static_cast<std::uint64_t>(n) + 1;
    centres *= static_cast<std::uint64_t>(n) + 2;
    if (corners > std::uint64_t{1} << 40) break;
  }
  return corners + centres;
}

Points::Points(const BccLattice& lattice)
    : lattice_(lattice),
      n_(lattice.cells),
      corner_count_(static_cast<std::uint32_t>(lattice.corners.node_count())),
      signs_(point_count(lattice), Sign::outside),
      crossed_(signs_.size()) {
  const auto stride = [&](std::int32_t more) {
    const auto x = static_cast<std::uint32_t>(n_[0] + more), y = static_cast<std::uint32_t>(n_[1] + more);
    return std::array<std::uint32_t, 3>{1, x, x * y};
  };
  corner_stride_ = stride(1);
  centre_stride_ = stride(2);
}

Index3 Points::index(std::uint32_t id) const {
  const std::int32_t shift = is_centre(id) ? 1 : 0;
  const auto& stride = is_centre(id) ? centre_stride_ : corner_stride_;
  if (is_centre(id)) id -= corner_count_;
  return {static_cast<std::int32_t>(id % stride[1]) - shift,
          static_cast<std::int32_t>(id % stride[2] / stride[1]) - shift,
          static_cast<std::int32_t>(id / stride[2]) - shift};
}

Vec3 Points::position(std::uint32_t id) const {
  const Index3 i = index(id);
  if (!is_centre(id)) return lattice_.corners.node(i[0], i[1], i[2]);
  Vec3 p;
  for (std::size_t a = 0; a < 3; ++a) p[a] = lattice_.box.min[a] + (i[a] + 0.5) * lattice_.spacing;
  return p;
}

void Points::mark_crossings(std::uint32_t owner) {
  const Index3 i = index(owner);
  std::uint16_t crossed = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const bool has_next = i[a] < n_[a];
    if (has_next && differ(owner, owner + stride(owner, a))) crossed |= static_cast<std::uint16_t>(1U << a);
  }
  if (is_centre(owner) && in_box(i))
    for (unsigned e = 0; e < short_edges; ++e)
      if (differ(owner, short_end(i, e))) crossed |= static_cast<std::uint16_t>(1U << (long_edges + e));
  crossed_[owner] = crossed;
}

std::uint64_t Points::count_crossings() {
  first_cut_.resize(signs_.size());
  std::uint64_t count = 0;
  for (std::size_t id = 0; id < signs_.size(); ++id) {
    first_cut_[id] = static_cast<std::uint32_t>(count);
    count += static_cast<std::uint64_t>(std::popcount(crossed_[id]));
  }
  return count;
}

}  // namespace stuffing
}  // namespace meso::implicit
