// SPDX-License-Identifier: Apache-2.0
#pragma once
// The records that an interpolated value is made of, and their weights, which add up to 1.

#include <array>
#include <cstddef>
#include <cstdint>

#include "meso/fields/records.hpp"

namespace meso::fields {

inline constexpr std::size_t most_neighbours = 8;

struct Stencil {
  std::array<std::int64_t, most_neighbours> record{};
  std::array<double, most_neighbours> weight{};
  std::size_t count = 0;

  void add(std::int64_t r, double w) {
    if (w == 0) return;  // exact at the records: others take no part
    record[count] = r;
    weight[count++] = w;
  }
  [[nodiscard]] double operator()(const Records& records, std::size_t column) const {
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) sum += weight[i] * records(static_cast<std::size_t>(record[i]), column);
    return sum;
  }
};

}  // namespace meso::fields
