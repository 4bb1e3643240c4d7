// SPDX-License-Identifier: Apache-2.0
#include "fit_floats.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "meso/implicit/flat_term.hpp"
#include "spread_points.hpp"

namespace meso::implicit {

Graph::Id fit_to_floats(Graph& graph, Graph::Id root, const Term& term, const Grid& grid) {
  // Floats are full from 2^-126 to 2^128; what counts are values beside a zero, which are some binades smaller.
  constexpr int most = 96;
  const std::array<Vec3, 63> points = spread_points<63>(grid.box);
  std::array<double, 63> values{};
  FlatTerm(term).values(points, values);
  for (double& v : values) v = std::isfinite(v) ? std::abs(v) : 0;
  const auto last = std::remove(values.begin(), values.end(), 0.0);
  if (last == values.begin()) return root;
  // The usual size, not the largest: a pole somewhere must not make all else small.
  const auto middle = values.begin() + (last - values.begin()) / 2;
  std::nth_element(values.begin(), middle, last);
  const int exponent = std::ilogb(*middle);
  if (std::abs(exponent) <= most) return root;
  // In two steps: the factor itself must be a double.
  const int half = exponent / 2;
  for (const int step : {half, exponent - half})
    root = graph.apply(expr::Op::multiply, {root, graph.number(std::ldexp(1.0, -step))});
  return root;
}

}  // namespace meso::implicit
