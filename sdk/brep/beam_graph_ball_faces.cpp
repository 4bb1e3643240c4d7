// SPDX-License-Identifier: Apache-2.0
#include "beam_graph_ball_faces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;

Vec3 unit(Vec3 v) { return v / norm(v); }
Vec3 across(Vec3 v) { return unit(cross(v, std::fabs(v.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})); }

/// Is that place on the left of a loop of places on a sphere? Seen from there, the loop runs clockwise then.
bool has_on_left(const UnitLoop& loop, Vec3 p) {
  const Vec3 x = across(p), y = cross(p, x);
  const auto place = [&](Vec3 n) {
    const double depth = std::max(1e-12, 1 - dot(n, p));
    return std::array{dot(n, x) / depth, dot(n, y) / depth};
  };
  double twice = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const auto a = place(loop[i]), b = place(loop[(i + 1) % loop.size()]);
    twice += a[0] * b[1] - a[1] * b[0];
  }
  return twice > 0;
}

}  // namespace

std::optional<AxisFrame> axes_off(Vec3 centre, const std::vector<UnitLoop>& loops, int variant) {
  constexpr int poles = 48, azimuths = 16;
  const auto on_face = [&](Vec3 p) {
    return std::ranges::all_of(loops, [&](const auto& l) { return has_on_left(l, p); });
  };
  std::optional<AxisFrame> best;
  double most = 1e-3;
  const auto consider = [&](Vec3 z, Vec3 x) {
    const Vec3 y = cross(z, x);
    double least = 1;
    for (const auto& loop : loops)
      for (const Vec3& p : loop) {
        least = std::min(least, dot(p, x) > 0 ? std::fabs(dot(p, y)) : std::hypot(dot(p, x), dot(p, y)));
        if (least <= most) return;
      }
    if (on_face(z) || on_face(-z) || on_face(x)) return;
    most = least;
    best = AxisFrame{centre, z, x};
  };
  for (int i = 0; i < poles && most < 0.6; ++i) {
    const double h = (i + 0.5) / poles, r = std::sqrt(1 - h * h), turn = 2.399963229728653 * i + variant;
    const Vec3 z{r * std::cos(turn), r * std::sin(turn), h}, x = across(z), y = cross(z, x);
    for (int a = 0; a < azimuths; ++a)
      consider(z, std::cos(2 * pi * a / azimuths) * x + std::sin(2 * pi * a / azimuths) * y);
  }
  return best;
}

std::vector<std::vector<std::size_t>> loops_of_faces(const std::vector<UnitLoop>& loops) {
  std::vector<std::vector<std::size_t>> faces;
  std::vector<bool> taken(loops.size(), false);
  for (std::size_t l = 0; l < loops.size(); ++l) {
    if (taken[l]) continue;
    faces.push_back({l});
    for (std::size_t m = l + 1; m < loops.size(); ++m) {
      if (taken[m]) continue;
      const Vec3 p = loops[l].front(), q = loops[m].front();
      bool together = has_on_left(loops[l], q) && has_on_left(loops[m], p);
      for (std::size_t n = 0; together && n < loops.size(); ++n)
        together = n == l || n == m || has_on_left(loops[n], p) == has_on_left(loops[n], q);
      if (!together) continue;
      taken[m] = true;
      faces.back().push_back(m);
    }
  }
  return faces;
}

}  // namespace meso::brep
