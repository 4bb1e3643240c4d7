// SPDX-License-Identifier: Apache-2.0
#pragma once
// Which edges into the added layer have a vertex of their own.
//
// A node on an edge or corner of the box has two or three edges into the layer, and their vertices would coincide in
// the node. They are one vertex: that of the edge along x, else along y.

#include "layout.hpp"

namespace meso::implicit {

class PadVertices {
 public:
  PadVertices(const Layout& layout, std::size_t j, std::size_t k) : last_(layout.nx - 1) {
    y_ = j == 0 || j == layout.ny ? Own::inner : Own::all;
    z_ = k > 0 && k < layout.nz ? Own::all : j == 0 || j + 1 == layout.ny ? Own::none : Own::inner;
  }
  /// Of the nodes of word w, those whose edge along y (z) has its own vertex.
  [[nodiscard]] std::uint64_t y_mask(std::size_t w) const { return mask(y_, w); }
  [[nodiscard]] std::uint64_t z_mask(std::size_t w) const { return mask(z_, w); }

 private:
  enum class Own { all, inner, none };

  [[nodiscard]] std::uint64_t mask(Own own, std::size_t w) const {
    if (own != Own::inner) return own == Own::all ? ~std::uint64_t{0} : 0;
    std::uint64_t bits = ~std::uint64_t{0};
    if (w == 0) bits ^= 1;
    if (w == last_ / 64) bits ^= std::uint64_t{1} << last_ % 64;
    return bits;
  }

  std::size_t last_;
  Own y_, z_;
};

}  // namespace meso::implicit
