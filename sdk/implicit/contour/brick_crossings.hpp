// SPDX-License-Identifier: Apache-2.0
#pragma once
// The crossed edges of a brick and of the plane below it, kept while its cells are looked at for sharp edges.

#include <algorithm>
#include <span>
#include <vector>

#include "bits.hpp"
#include "layout.hpp"

namespace meso::implicit {

class BrickCrossings {
 public:
  explicit BrickCrossings(const Layout& layout) : layout_(layout), stride_(layout.words + 1) {
    for (auto& edges : at_node_) edges.resize(layout.nx + 1);
  }

  struct Row {
    std::size_t first_point = 0, first_node = 0;
    std::size_t nx = 0, ny = 0, nz = 0;
    [[nodiscard]] std::size_t points() const { return nx + ny + nz; }
  };

  /// Planes [first_plane, ...) come next, row by row, 0 ... ny.
  void begin(std::size_t first_plane) {
    first_plane_ = first_plane;
    rows_.clear(), nodes_.clear(), signs_.clear();
  }
  void add_row(std::size_t first_point, std::span<const std::uint16_t> x, std::span<const std::uint16_t> y,
               std::span<const std::uint16_t> z, const std::uint64_t* inside) {
    rows_.push_back({first_point, nodes_.size(), x.size(), y.size(), z.size()});
    for (const auto& list : {x, y, z}) nodes_.insert(nodes_.end(), list.begin(), list.end());
    signs_.push_back(0);
    signs_.insert(signs_.end(), inside, inside + layout_.words);
  }

  [[nodiscard]] std::size_t first_plane() const { return first_plane_; }
  [[nodiscard]] const Row& row(std::size_t j, std::size_t k) const { return rows_[index(j, k)]; }
  /// at(...)[-1] is 0.
  [[nodiscard]] const std::uint64_t* signs(std::size_t j, std::size_t k) const {
    return signs_.data() + index(j, k) * stride_ + 1;
  }
  [[nodiscard]] std::uint64_t bytes() const {
    return rows_.capacity() * sizeof(Row) + nodes_.capacity() * sizeof(std::uint16_t) +
           signs_.capacity() * sizeof(std::uint64_t);
  }

  /// Prepares point_of_edge() for the cells between rows j - 1, j of the planes k - 1, k, all of them nodes of the
  /// grid.
  void enter_cells(std::size_t j, std::size_t k) {
    const std::size_t corner_row[4] = {index(j - 1, k - 1), index(j, k - 1), index(j - 1, k), index(j, k)};
    for (std::size_t r = 0; r < 4; ++r) take(rows_[corner_row[r]], 0, at_node_[r]);
    take(rows_[corner_row[1]], 1, at_node_[4]);
    take(rows_[corner_row[3]], 1, at_node_[5]);
    take(rows_[corner_row[2]], 2, at_node_[6]);
    take(rows_[corner_row[3]], 2, at_node_[7]);
  }
  /// The point on a crossed edge of the cell between nodes cell - 1 and cell.
  [[nodiscard]] std::size_t point_of_edge(std::size_t cell, std::uint8_t edge) const {
    if (edge < 4) return at_node_[edge][cell];
    return at_node_[4 + (edge - 4) / 2][cell - 1 + edge % 2];
  }

 private:
  [[nodiscard]] std::size_t index(std::size_t j, std::size_t k) const {
    return (k - first_plane_) * (layout_.ny + 1) + j;
  }
  void take(const Row& row, std::size_t axis, std::vector<std::uint32_t>& to) const {
    const std::size_t skipped = axis == 0 ? 0 : axis == 1 ? row.nx : row.nx + row.ny;
    const std::size_t count = axis == 0 ? row.nx : axis == 1 ? row.ny : row.nz;
    for (std::size_t n = skipped; n < skipped + count; ++n)
      to[nodes_[row.first_node + n]] = static_cast<std::uint32_t>(row.first_point + n);
  }

  const Layout& layout_;
  std::size_t stride_, first_plane_ = 0;
  std::vector<Row> rows_;
  std::vector<std::uint16_t> nodes_;
  std::vector<std::uint64_t> signs_;
  std::vector<std::uint32_t> at_node_[8];  // numbers of points by node: four rows of x, two of y, two of z
};

}  // namespace meso::implicit
