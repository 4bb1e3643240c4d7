// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstddef>

#include "meso/expr/operations.hpp"
#include "row_kernels.hpp"

namespace meso::implicit {
namespace {

void hash(const Input* in, std::size_t count, double* out, std::size_t n) {
  std::array<double, 8> arguments{};
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < count; ++k) arguments[k] = in[k].values[in[k].uniform ? 0 : i];
    out[i] = expr::apply_hash({arguments.data(), count});
  }
}

}  // namespace

void fill_lane_kernels(RowKernels& kernels) { kernels.of_op[static_cast<std::size_t>(expr::Op::hash)] = hash; }

}  // namespace meso::implicit
