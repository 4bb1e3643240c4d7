// SPDX-License-Identifier: Apache-2.0
#include <cassert>

#include "meso/implicit/compile.hpp"
#include "row_kernels.hpp"

namespace meso::implicit {

bool is_supported(InstructionSet set) {
  switch (set) {
    case InstructionSet::avx512:
      return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
             __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
    case InstructionSet::avx2:
      return __builtin_cpu_supports("avx2");
    default:
      return true;
  }
}

const RowKernels& row_kernels(InstructionSet set) {
  const auto filled = [](void (*fill)(RowKernels&)) {
    RowKernels kernels;
    fill(kernels);
    fill_lane_kernels(kernels);
    return kernels;
  };
  if (set == InstructionSet::automatic) {
    set = is_supported(InstructionSet::avx512) ? InstructionSet::avx512
          : is_supported(InstructionSet::avx2) ? InstructionSet::avx2
                                               : InstructionSet::sse2;
  }
  assert(is_supported(set));
  if (set == InstructionSet::avx512) {  // even to fill the table takes the instruction set
    static const RowKernels kernels = filled(avx512::fill);
    return kernels;
  }
  if (set == InstructionSet::avx2) {
    static const RowKernels kernels = filled(avx2::fill);
    return kernels;
  }
  static const RowKernels kernels = filled(sse2::fill);
  return kernels;
}

}  // namespace meso::implicit
