// SPDX-License-Identifier: Apache-2.0
#include "beam_graph_spans.hpp"

#include <cmath>
#include <cstddef>
#include <utility>

namespace meso::brep {
namespace {

constexpr std::size_t count = span_degree + 1;
using Weights = std::array<double, count>;

Weights bernstein(int degree, double t) {
  Weights out{1};
  for (int d = 1; d <= degree; ++d)
    for (int k = d; k >= 0; --k) {
      const auto n = static_cast<std::size_t>(k);
      out[n] = (k < d ? (1 - t) * out[n] : 0) + (k > 0 ? t * out[n - 1] : 0);
    }
  return out;
}

Weights bernstein_slopes(double t) {
  const Weights lower = bernstein(span_degree - 1, t);
  Weights out{};
  for (std::size_t k = 0; k < count; ++k)
    out[k] = span_degree * ((k > 0 ? lower[k - 1] : 0) - (k + 1 < count ? lower[k] : 0));
  return out;
}

/// Poles by the eight conditions: the inverse of what the poles are multiplied with. Gauss and Jordan, by rows.
std::array<Weights, count> inverse_of_conditions() {
  std::array<Weights, count> rows{}, inverse{};
  for (std::size_t k = 0; k < span_places.size(); ++k) {
    rows[2 * k] = bernstein(span_degree, span_places[k]);
    rows[2 * k + 1] = bernstein_slopes(span_places[k]);
  }
  for (std::size_t i = 0; i < count; ++i) inverse[i][i] = 1;
  for (std::size_t column = 0; column < count; ++column) {
    std::size_t best = column;
    for (std::size_t row = column; row < count; ++row)
      if (std::fabs(rows[row][column]) > std::fabs(rows[best][column])) best = row;
    std::swap(rows[best], rows[column]);
    std::swap(inverse[best], inverse[column]);
    const double pivot = rows[column][column];
    for (std::size_t k = 0; k < count; ++k) {
      rows[column][k] /= pivot;
      inverse[column][k] /= pivot;
    }
    for (std::size_t row = 0; row < count; ++row) {
      if (row == column) continue;
      const double factor = rows[row][column];
      for (std::size_t k = 0; k < count; ++k) {
        rows[row][k] -= factor * rows[column][k];
        inverse[row][k] -= factor * inverse[column][k];
      }
    }
  }
  return inverse;
}

}  // namespace

SpanPoles span_poles(const std::array<Vec3, 4>& points, const std::array<Vec3, 4>& tangents) {
  static const std::array<Weights, count> inverse = inverse_of_conditions();
  SpanPoles poles{};
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < points.size(); ++k)
      poles[i] += inverse[i][2 * k] * points[k] + inverse[i][2 * k + 1] * tangents[k];
  // Spans that follow each other share these to the last bit.
  poles.front() = points.front();
  poles.back() = points.back();
  return poles;
}

Vec3 point_of(const SpanPoles& poles, double t) {
  const Weights weights = bernstein(span_degree, t);
  Vec3 out;
  for (std::size_t k = 0; k < count; ++k) out += weights[k] * poles[k];
  return out;
}

}  // namespace meso::brep
