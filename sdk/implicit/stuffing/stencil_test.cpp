// SPDX-License-Identifier: Apache-2.0
#include "stencil.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "lattice.hpp"

namespace meso::implicit::stuffing {
namespace {

constexpr std::array<Vec3, 4> lattice_tet{{{0, 0, 0}, {1, 0, 0}, {.5, .5, -.5}, {.5, .5, .5}}};

std::array<Sign, 4> signs_of(int code) {
  std::array<Sign, 4> signs{};
  for (Sign& s : signs) {
    s = static_cast<Sign>(code % 3);
    code /= 3;
  }
  return signs;
}

double volume(const std::array<Vec3, 4>& p) { return dot(cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0]) / 6; }

struct Range {
  double min = 180, max = 0, volume = 1;
};

void widen(Range& range, const std::array<Vec3, 4>& p) {
  range.volume = std::min(range.volume, volume(p));
  std::array<Vec3, 4> n{cross(p[2] - p[1], p[3] - p[1]), cross(p[3] - p[0], p[2] - p[0]),
                        cross(p[1] - p[0], p[3] - p[0]), cross(p[2] - p[0], p[1] - p[0])};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) {
      const double angle = std::acos(-dot(n[i], n[j]) / norm(n[i]) / norm(n[j])) * 180 / std::numbers::pi;
      range.min = std::min(range.min, angle);
      range.max = std::max(range.max, angle);
    }
}

/// Everything that can happen to a lattice tetrahedron, at random and mostly at its extremes: points on the surface
/// have moved along one of their fourteen edges, towards what was on the other side; cuts keep away from points.
class Anything {
 public:
  Anything() {
    for (std::size_t a = 0; a < 3; ++a)
      for (const double s : {-1.0, 1.0}) {
        Vec3 d;
        d[a] = s * close_on_long;
        moves_.push_back(d);
      }
    for (unsigned e = 0; e < short_edges; ++e)
      moves_.push_back(close_on_short * Vec3{e & 1 ? .5 : -.5, e & 2 ? .5 : -.5, e & 4 ? .5 : -.5});
  }

  /// False: this cannot happen.
  bool next(const std::array<Sign, 4>& signs) {
    std::array<int, 4> side{}, towards{-1, -1, -1, -1};
    for (std::size_t i = 0; i < 4; ++i) {
      at[i] = lattice_tet[i];
      side[i] = signs[i] == Sign::inside || (signs[i] == Sign::zero && random_() % 2 == 0) ? 1 : 0;
      if (signs[i] != Sign::zero || random_() % 8 == 0) continue;
      const Vec3 move = moves_[random_() % moves_.size()];
      at[i] = lattice_tet[i] + (random_() % 4 == 0 ? uniform() : 1.0) * move;
      for (std::size_t j = 0; j < 4; ++j)
        if (j != i && norm(cross(lattice_tet[j] - lattice_tet[i], move)) < 1e-9 &&
            dot(lattice_tet[j] - lattice_tet[i], move) > 0)
          towards[i] = static_cast<int>(j);
    }
    for (std::size_t i = 0; i < 4; ++i) {
      if (towards[i] < 0) continue;
      const auto j = static_cast<std::size_t>(towards[i]);
      if (side[i] == side[j] || towards[j] == static_cast<int>(i)) return false;
    }
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = a + 1; b < 4; ++b) {
        const double close = a / 2 == b / 2 ? close_on_long : close_on_short;
        const double t = random_() % 4 == 0   ? close + uniform() * (1 - 2 * close)
                         : random_() % 2 == 0 ? close
                                              : 1 - close;
        at[edge_node(a, b)] = (1 - t) * lattice_tet[a] + t * lattice_tet[b];
      }
    return true;
  }

  std::array<Vec3, 10> at;

 private:
  double uniform() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  std::mt19937_64 random_{7};
  std::vector<Vec3> moves_;
};

TEST(Stencil, AnglesKeepThePublishedBoundAndComeCloseToIt) {
  Range all;
  Anything anything;
  for (int code = 0; code < 81; ++code) {
    const auto signs = signs_of(code);
    for (int trial = 0; trial < 12000; ++trial) {
      if (!anything.next(signs)) continue;
      const Stencil& s = stencil(signs, trial % 2 == 0);
      for (std::size_t t = 0; t < s.count; ++t) {
        const LocalTet& n = s.tets[t];
        widen(all, {anything.at[n[0]], anything.at[n[1]], anything.at[n[2]], anything.at[n[3]]});
      }
    }
  }
  EXPECT_GE(all.min, 10.7);
  EXPECT_LE(all.max, 164.8);
  EXPECT_GT(all.volume, 0);
  // If these were far away, the search would not have looked hard enough.
  EXPECT_LT(all.min, 11.2);
  EXPECT_GT(all.max, 164.2);
}

TEST(Stencil, PiecesInsideAndOutsideFillTheTetrahedron) {
  const double whole = volume(lattice_tet);
  std::array<Vec3, 10> at{};
  for (std::size_t a = 0; a < 4; ++a) {
    at[a] = lattice_tet[a];
    for (std::size_t b = a + 1; b < 4; ++b) at[edge_node(a, b)] = 0.6 * lattice_tet[a] + 0.4 * lattice_tet[b];
  }
  const auto filled = [&](const std::array<Sign, 4>& signs, bool even) {
    double sum = 0;
    const Stencil& s = stencil(signs, even);
    for (std::size_t t = 0; t < s.count; ++t) {
      const double v = volume({at[s.tets[t][0]], at[s.tets[t][1]], at[s.tets[t][2]], at[s.tets[t][3]]});
      EXPECT_GT(v, 0);
      sum += v;
    }
    return sum;
  };
  for (int code = 0; code < 81; ++code) {
    const auto signs = signs_of(code);
    auto opposite = signs;
    for (Sign& s : opposite) s = static_cast<Sign>(2 - static_cast<int>(s));
    if (signs == std::array{Sign::zero, Sign::zero, Sign::zero, Sign::zero}) continue;
    for (const bool even : {false, true}) {
      // With two inside and two outside the surface's own diagonal need not be the same from both sides.
      const bool saddle = std::count(signs.begin(), signs.end(), Sign::inside) == 2 &&
                          std::count(signs.begin(), signs.end(), Sign::outside) == 2;
      EXPECT_NEAR(filled(signs, even) + filled(opposite, even), whole, saddle ? 0.05 * whole : 1e-12) << code;
    }
  }
}

}  // namespace
}  // namespace meso::implicit::stuffing
