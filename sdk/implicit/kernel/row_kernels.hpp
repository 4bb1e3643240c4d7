// SPDX-License-Identifier: Apache-2.0
#pragma once
// The arithmetic of whole rows, one function per operation, built once per instruction set from one source. Every
// sample goes through the same IEEE operations in the same order in each build, so results are equal to the bit.

#include <cstddef>
#include <cstdint>

#include "graph.hpp"
#include "meso/implicit/compile.hpp"

namespace meso::implicit {

/// Rows are computed in pieces of this many samples; every array's start is aligned to 64 bytes and padded to it.
inline constexpr std::size_t row_unit = 16;

/// An operand: a row of values, or one value for the whole row.
struct Input {
  const double* values = nullptr;
  bool uniform = false;
};

/// out[i] = op(inputs[0][i], ...) for i < n. REQUIRES: n is a multiple of row_unit. `out` may be an input.
using Kernel = void (*)(const Input* inputs, std::size_t count, double* out, std::size_t n);
/// values[i] = float(v[i]); bit i % 16 of inside[i / 16] tells whether v[i] is negative.
using StoreKernel = void (*)(const Input* inputs, std::size_t count, float* values, std::uint16_t* inside,
                             std::size_t n);

struct RowKernels {
  Kernel of_op[op_count]{};             ///< of every operation with operands
  StoreKernel store{};                  ///< of one input
  StoreKernel store_sum_of_products{};  ///< of a sum of products that is never kept in double
};

/// For as long as the program runs.
[[nodiscard]] const RowKernels& row_kernels(InstructionSet set);

namespace sse2 {
void fill(RowKernels& kernels);
}
namespace avx2 {
void fill(RowKernels& kernels);
}
namespace avx512 {
void fill(RowKernels& kernels);
}
/// hash: whole numbers, sample by sample, the same code for every instruction set.
void fill_lane_kernels(RowKernels& kernels);

}  // namespace meso::implicit
