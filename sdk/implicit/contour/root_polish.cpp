// SPDX-License-Identifier: Apache-2.0
#include "root_polish.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace meso::implicit {

void RootPolish::add(Vec3 p, std::size_t axis, double step, double v0, double v1, std::size_t result) {
  Edge e{.p = p, .step = step, .va = v0, .vb = v1, .result = result, .axis = static_cast<std::uint8_t>(axis)};
  if (!std::signbit(v0) || std::isnan(v0)) {  // a float may have rounded a negative value to -0
    std::swap(e.a, e.b);
    std::swap(e.va, e.vb);
  }
  edges_.push_back(e);
}

Vec3 RootPolish::at(const Edge& e, double t) {
  Vec3 p = e.p;
  p[e.axis] += t * e.step;
  return p;
}

// Where the line through both ends is zero; the middle where there is none.
double RootPolish::linear_root(const Edge& e) {
  const double t = (e.vb * e.a - e.va * e.b) / (e.vb - e.va);
  const bool between = std::min(e.a, e.b) <= t && t <= std::max(e.a, e.b);
  return between ? t : (e.a + e.b) / 2;
}

double RootPolish::next(const Edge& e, int round) {
  constexpr int bisections = 22;  // of a unit bracket down to 2 * accuracy, and one to spare
  constexpr double k1 = 0.2;      // of the bracket's square: how far to step over the linear root, towards the middle
  const double middle = (e.a + e.b) / 2, width = std::fabs(e.b - e.a), linear = linear_root(e);
  const double side = middle < linear ? -1 : 1;
  const double shift = k1 * width * width;
  const double over = shift <= std::fabs(middle - linear) ? linear + side * shift : middle;
  const double radius = std::max(0.0, std::ldexp(accuracy, bisections - round) - width / 2);
  return std::fabs(over - middle) <= radius ? over : middle - side * radius;
}

void RootPolish::solve(GridSampler& sampler, std::vector<Vec3>& results) {
  for (int round = 0; !edges_.empty(); ++round) {
    std::erase_if(edges_, [&](const Edge& e) {
      if (std::fabs(e.b - e.a) > 2 * accuracy) return false;
      // A vertex in a node would fold its triangles up.
      const double margin = std::clamp(2 * coordinate_step_ / std::fabs(e.step), 2 * accuracy, 0.25);
      results[e.result] = at(e, std::clamp(linear_root(e), margin, 1 - margin));
      return true;
    });
    t_.clear();
    points_.clear();
    for (const Edge& e : edges_) {
      t_.push_back(next(e, round));
      points_.push_back(at(e, t_.back()));
    }
    values_.resize(points_.size());
    sampler.values_at(points_, values_.data());
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      Edge& e = edges_[i];
      const bool inside = values_[i] < 0;
      (inside ? e.a : e.b) = t_[i];
      (inside ? e.va : e.vb) = values_[i];
    }
  }
}

}  // namespace meso::implicit
