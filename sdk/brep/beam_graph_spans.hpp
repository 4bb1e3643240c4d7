// SPDX-License-Identifier: Apache-2.0
#pragma once
// A span of a curve as a polynomial of degree 7 that has the curve's points and tangents at four places: it is off by a
// hundred-thousandth of what a cubic is off by, so that curves need a tenth of the spans. Private. Thread rule: pure.

#include <array>

#include "meso/base/vec.hpp"

namespace meso::brep {

inline constexpr int span_degree = 7;
/// Parts of the span.
inline constexpr std::array<double, 4> span_places{0, 0.25, 0.75, 1};
/// In Bernstein's form.
using SpanPoles = std::array<Vec3, span_degree + 1>;

/// Tangents are by the parameter that runs from 0 to 1.
[[nodiscard]] SpanPoles span_poles(const std::array<Vec3, 4>& points, const std::array<Vec3, 4>& tangents);
[[nodiscard]] Vec3 point_of(const SpanPoles& poles, double t);

}  // namespace meso::brep
