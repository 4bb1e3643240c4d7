// SPDX-License-Identifier: Apache-2.0
#include "axis.hpp"

#include <cassert>
#include <cmath>

#include "meso/base/number.hpp"

namespace meso {
namespace {

/// n * 10^exponent, correctly rounded for the small n of ticks (0.3, not 0.30000000000000004).
double scaled(double n, int exponent) {
  return exponent < 0 ? n / std::pow(10.0, -exponent) : n * std::pow(10.0, exponent);
}

int decade_of(double value) {
  int k = static_cast<int>(std::floor(std::log10(value)));
  while (scaled(1, k + 1) <= value) ++k;
  while (scaled(1, k) > value) --k;
  return k;
}

Axis linear_axis(double min, double max) {
  if (min > 0) min = 0;
  if (max < 0) max = 0;
  if (min == max) max = min + 1;
  // The smallest step of 1, 2 or 5 times a power of ten that needs at most six of itself.
  const double wanted = (max - min) / 6;
  const int k = decade_of(wanted);
  int n = 1;
  while (n < 10 && scaled(n, k) < wanted * (1 - 1e-12)) n = n == 1 ? 2 : n == 2 ? 5 : 10;
  const double step = scaled(n, k);
  const auto first = std::lround(std::floor(min / step + 1e-9)), last = std::lround(std::ceil(max / step - 1e-9));

  Axis axis;
  for (auto i = first; i <= last; ++i) {
    const double value = scaled(static_cast<double>(i * n), k);
    axis.ticks.push_back({value, tick_label(value)});
  }
  axis.low = axis.ticks.front().value;
  axis.high = axis.ticks.back().value;
  return axis;
}

Axis log_axis(double min, double max) {
  assert(min > 0);
  const auto is_end = [](int n) { return n == 1 || n == 2 || n == 5; };
  Axis axis{.log = true, .low = min, .high = max, .ticks = {}};
  const int low = decade_of(min), high = decade_of(max);
  // Ends on 1, 2 or 5 times a power of ten.
  for (const int n : {1, 2, 5})
    if (scaled(n, low) <= min) axis.low = scaled(n, low);
  for (const int n : {10, 5, 2, 1})
    if (scaled(n, high) >= max) axis.high = scaled(n, high);
  if (axis.low == axis.high) axis.high = scaled(10, high);

  // Few decades: name 2 and 5 too. Many: name every second, third ... one.
  const int decades = high - low;
  const int stride = 1 + decades / 9;
  for (int k = low; k <= high + 1; ++k)
    for (int n = 1; n <= 9; ++n) {
      const double value = scaled(n, k);
      if (value < axis.low || value > axis.high) continue;
      const bool named = n == 1 ? (k - low) % stride == 0 : decades <= 2 && is_end(n);
      axis.ticks.push_back({value, named ? tick_label(value) : std::string()});
    }
  return axis;
}

}  // namespace

double Axis::fraction(double value) const {
  return log ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
}

Axis axis_for(double min, double max, bool log) { return log ? log_axis(min, max) : linear_axis(min, max); }

std::string tick_label(double value) {
  for (const auto& [size, suffix] : {std::pair{9, "G"}, {6, "M"}, {3, "k"}})
    if (std::abs(value) >= scaled(1, size)) return format_number(scaled(value, -size)) + suffix;
  return format_number(value);
}

}  // namespace meso
