// SPDX-License-Identifier: Apache-2.0
#pragma once
// Blocks of 4 x 4 x 4 nodes in which the distance may be as small as a band.

#include <vector>

#include "meso/implicit/grid.hpp"
#include "signed_mesh.hpp"

namespace meso::implicit {

class NearBlocks {
 public:
  static constexpr std::int32_t edge = 4;

  /// Cut short by `stop`, it means nothing.
  NearBlocks(const SignedMesh& mesh, const Grid& grid, const Affine& field_from_grid, double band, StopPoll& stop);

  [[nodiscard]] bool contains(std::int32_t i, std::int32_t j, std::int32_t k) const {
    return near_[index(i / edge, j / edge, k / edge)] != 0;
  }

 private:
  [[nodiscard]] std::size_t index(std::int32_t i, std::int32_t j, std::int32_t k) const {
    return (std::size_t(k) * std::size_t(blocks_[1]) + std::size_t(j)) * std::size_t(blocks_[0]) + std::size_t(i);
  }

  std::array<std::int32_t, 3> blocks_;
  std::vector<char> near_;  // not bits: threads write side by side
};

}  // namespace meso::implicit
