// SPDX-License-Identifier: Apache-2.0
#pragma once
// Moves vertices along their edges to where the field itself is zero, many at a time.
//
// Each edge is a bracket with the inside at one end. The ITP method (Oliveira and Takahashi 2020) keeps brackets,
// converges superlinearly on smooth fields, and never takes more than one evaluation over bisection; where a field has
// no value at one end, or jumps, it ends at the border of the inside.

#include <vector>

#include "meso/base/vec.hpp"
#include "meso/implicit/grid_source.hpp"

namespace meso::implicit {

class RootPolish {
 public:
  /// See ContourOptions::coordinate_step.
  explicit RootPolish(double coordinate_step) : coordinate_step_(coordinate_step) {}

  /// The distance from the root, in lengths of the edge, that is always reached.
  static constexpr double accuracy = 2.5e-7;

  /// An edge from p along `axis` by `step`, with values at its ends; `result` is where its vertex goes.
  void add(Vec3 p, std::size_t axis, double step, double v0, double v1, std::size_t result);
  /// Solves and forgets all edges.
  void solve(GridSampler& sampler, std::vector<Vec3>& results);

 private:
  struct Edge {
    Vec3 p;
    double step;
    double a = 0, b = 1, va, vb;  // t and values of the inside end and the outside end
    std::size_t result;
    std::uint8_t axis;
  };

  static double next(const Edge& e, int round);
  static double linear_root(const Edge& e);
  static Vec3 at(const Edge& e, double t);

  double coordinate_step_;
  std::vector<Edge> edges_;
  std::vector<double> t_, values_;
  std::vector<Vec3> points_;
};

}  // namespace meso::implicit
