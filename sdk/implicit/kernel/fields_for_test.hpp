// SPDX-License-Identifier: Apache-2.0
#pragma once
// Terms from text, whole grids of samples, and other things that several tests of this room want.

#include <gtest/gtest.h>

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
  std::size_t words = 0;  ///< of a row
  std::vector<float> values;
  std::vector<std::uint64_t> inside;

  Samples(const GridSource& source, std::int32_t slab) {
    const Grid& g = source.grid();
    const std::size_t pitch = padded(std::size_t(g.nodes[0]));
    words = pitch / 64;
    values.resize(pitch * std::size_t(g.nodes[1]) * std::size_t(g.nodes[2]), -77.f);
    inside.resize(values.size() / 64, ~std::uint64_t{0});
    const AlignedArray row_memory(pitch), bits_memory(words);
    const auto sampler = source.sampler();
    for (std::int32_t first = 0; first < g.nodes[2]; first += slab) {
      const std::int32_t last = std::min(first + slab, g.nodes[2]);
      sampler->begin_slab(first, last);
      for (std::int32_t k = first; k < last; ++k)
        for (std::int32_t j = 0; j < g.nodes[1]; ++j) {
          const std::size_t row = std::size_t(k) * std::size_t(g.nodes[1]) + std::size_t(j);
          auto* const v = reinterpret_cast<float*>(row_memory.data());
          auto* const bits = reinterpret_cast<std::uint64_t*>(bits_memory.data());
          std::fill_n(v, pitch, -77.f);
          sampler->row(j, k, v, bits);
          std::copy_n(v, pitch, values.data() + row * pitch);
          std::copy_n(bits, words, inside.data() + row * words);
        }
    }
  }
};

}  // namespace meso::implicit
