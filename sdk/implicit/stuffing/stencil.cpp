// SPDX-License-Identifier: Apache-2.0
#include "stencil.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "meso/base/vec.hpp"

namespace meso::implicit::stuffing {
namespace {

/// Two triangles and the diagonals between them.
struct Wedge {
  std::array<std::uint8_t, 3> bottom{}, top{};
  std::array<std::array<bool, 3>, 3> up{};  ///< up[i][j]: a diagonal goes from bottom[i] to top[j]
};

/// One entry of the table, after Labelle and Shewchuk 2007, figure 3.
class Maker {
 public:
  Maker(const std::array<Sign, 4>& signs, bool even) : even_(even) {
    for (std::uint8_t i = 0; i < 4; ++i) {
      if (signs[i] == Sign::inside) inside_.push_back(i);
      if (signs[i] == Sign::outside) outside_.push_back(i);
      if (signs[i] == Sign::zero) zero_.push_back(i);
    }
  }

  Stencil make() {
    if (inside_.empty()) return {};
    if (outside_.empty()) {
      add({0, 1, 2, 3});
    } else if (inside_.size() == 1) {
      one_inside();
    } else if (inside_.size() == 3) {
      three_inside();
    } else if (outside_.size() == 1) {
      pyramid();
    } else {
      two_and_two();
    }
    return stencil_;
  }

 private:
  void one_inside() {
    LocalTet tet{0, 1, 2, 3};
    for (const std::uint8_t m : outside_) tet[m] = edge_node(inside_[0], m);
    add(tet);
  }

  void pyramid() {
    std::uint8_t u = inside_[0], v = inside_[1];
    const std::uint8_t w = outside_[0];
    if (!diagonal_from(u, v, w)) std::swap(u, v);
    add({u, v, edge_node(v, w), zero_[0]});
    add({u, edge_node(v, w), edge_node(u, w), zero_[0]});
  }

  /// Corners below, their cuts above.
  void three_inside() {
    Wedge wedge;
    for (std::size_t i = 0; i < 3; ++i) {
      wedge.bottom[i] = inside_[i];
      wedge.top[i] = edge_node(inside_[i], outside_[0]);
      for (std::size_t j = 0; j < 3; ++j) wedge.up[i][j] = i != j && diagonal_from(inside_[i], inside_[j], outside_[0]);
    }
    split(wedge);
  }

  /// A triangle around each inside corner. The diagonal of the surface between them is free; one choice leaves no
  /// cycle.
  void two_and_two() {
    const std::uint8_t u = inside_[0], v = inside_[1], m = outside_[0], n = outside_[1];
    Wedge wedge{{u, edge_node(u, m), edge_node(u, n)}, {v, edge_node(v, m), edge_node(v, n)}, {}};
    wedge.up[0][1] = diagonal_from(u, v, m);
    wedge.up[0][2] = diagonal_from(u, v, n);
    wedge.up[1][0] = !wedge.up[0][1];
    wedge.up[2][0] = !wedge.up[0][2];
    wedge.up[1][2] = wedge.up[1][0];
    wedge.up[2][1] = !wedge.up[1][2];
    split(wedge);
  }

  /// Three tetrahedra. Diagonals that do not go round order the wedge's upright edges: first, second, third.
  void split(const Wedge& w) {
    std::array<std::size_t, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return w.up[i][j]; });
    const auto [i, j, k] = order;
    add({w.bottom[i], w.bottom[j], w.bottom[k], w.top[k]});
    add({w.bottom[i], w.bottom[j], w.top[j], w.top[k]});
    add({w.bottom[i], w.top[i], w.top[j], w.top[k]});
  }

  /// The quadrilateral u, v, cut of v-w, cut of u-w is divided by the diagonal from u (else by the one from v). Where
  /// the long edge is cut, the diagonal ends in that cut; else parity decides.
  [[nodiscard]] bool diagonal_from(std::uint8_t u, std::uint8_t v, std::uint8_t w) const {
    if (u / 2 == v / 2) return even_ ^ ((u ^ w) & 1);
    return v / 2 == w / 2;
  }

  void add(LocalTet tet) {
    static constexpr std::array<Vec3, 4> corners{{{0, 0, 0}, {2, 0, 0}, {1, 1, -1}, {1, 1, 1}}};
    std::array<Vec3, 10> at{corners[0], corners[1], corners[2], corners[3]};
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = a + 1; b < 4; ++b) at[edge_node(a, b)] = 0.5 * (corners[a] + corners[b]);
    const Vec3 o = at[tet[0]];
    if (dot(cross(at[tet[1]] - o, at[tet[2]] - o), at[tet[3]] - o) < 0) std::swap(tet[0], tet[1]);
    stencil_.tets[stencil_.count++] = tet;
  }

  bool even_;
  std::vector<std::uint8_t> inside_, outside_, zero_;
  Stencil stencil_;
};

std::size_t index_of(const std::array<Sign, 4>& signs, bool even) {
  std::size_t index = even ? 1 : 0;
  for (const Sign s : signs) index = 3 * index + static_cast<std::size_t>(s);
  return index;
}

std::array<Stencil, 162> make_table() {
  std::array<Stencil, 162> table;
  for (std::size_t code = 0; code < 81; ++code) {
    std::array<Sign, 4> signs{};
    for (std::size_t i = 0, rest = code; i < 4; ++i, rest /= 3) signs[i] = static_cast<Sign>(rest % 3);
    for (const bool even : {false, true}) table[index_of(signs, even)] = Maker(signs, even).make();
  }
  return table;
}

}  // namespace

const Stencil& stencil(const std::array<Sign, 4>& signs, bool even) {
  static const std::array<Stencil, 162> table = make_table();
  return table[index_of(signs, even)];
}

}  // namespace meso::implicit::stuffing
