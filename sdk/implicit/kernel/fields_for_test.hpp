// SPDX-License-Identifier: Apache-2.0
#pragma once
// Terms from text, whole grids of samples, and other things that several tests of this room want.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

#include "aligned_array.hpp"
#include "meso/implicit/compile.hpp"

namespace meso::implicit {

/// Names x, y, z.
inline Term term_of(std::string_view text) {
  const auto parsed = expr::parse_expression(text, LengthUnit::millimeter);
  EXPECT_TRUE(parsed.expression) << text;
  std::vector<Term> terms;
  for (const expr::Name& name : parsed.expression->names())
    terms.push_back(Term::coordinate(static_cast<std::size_t>(name.text[0] - 'x')));
  return Term::from_expression(*parsed.expression, terms);
}

/// Every row of a grid, in slabs.
struct Samples {
  static constexpr float untouched = -77;

  Grid grid;
  std::size_t pitch;  ///< of rows
  std::vector<float> values;
  std::vector<std::uint64_t> inside;

  Samples(const GridSource& source, std::int32_t slab)
      : grid(source.grid()), pitch(padded(std::size_t(grid.nodes[0]))) {
    const AlignedArray memory(pitch), bits_memory(pitch / 64);
    auto* const row = reinterpret_cast<float*>(memory.data());
    auto* const bits = reinterpret_cast<std::uint64_t*>(bits_memory.data());
    const auto sampler = source.sampler();
    for (std::int32_t first = 0; first < grid.nodes[2]; first += slab) {
      const std::int32_t last = std::min(first + slab, grid.nodes[2]);
      sampler->begin_slab(first, last);
      for (std::int32_t k = first; k < last; ++k)
        for (std::int32_t j = 0; j < grid.nodes[1]; ++j) {
          std::fill_n(row, pitch, untouched);
          sampler->row(j, k, row, bits);
          std::fill_n(row + grid.nodes[0], pitch - std::size_t(grid.nodes[0]), 0.f);  // what is there does not count
          values.insert(values.end(), row, row + pitch);
          inside.insert(inside.end(), bits, bits + pitch / 64);
        }
    }
  }

  [[nodiscard]] std::size_t index(std::int32_t i, std::int32_t j, std::int32_t k) const {
    return (std::size_t(k) * std::size_t(grid.nodes[1]) + std::size_t(j)) * pitch + std::size_t(i);
  }
  [[nodiscard]] float value(std::int32_t i, std::int32_t j, std::int32_t k) const { return values[index(i, j, k)]; }
  [[nodiscard]] bool is_inside(std::int32_t i, std::int32_t j, std::int32_t k) const {
    return (inside[index(i, j, k) / 64] >> i % 64 & 1) != 0;
  }
  /// NaN is one value: which bits it has is not told by IEEE 754.
  [[nodiscard]] std::vector<std::uint32_t> bytes() const {
    std::vector<std::uint32_t> result;
    for (const float v : values) result.push_back(std::isnan(v) ? 0x7fc00000 : std::bit_cast<std::uint32_t>(v));
    return result;
  }
};

}  // namespace meso::implicit
