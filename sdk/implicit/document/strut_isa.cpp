// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/compile.hpp"
#include "strut_rows.hpp"

namespace meso::implicit {

StrutRow strut_row() {
  if (is_supported(InstructionSet::avx512)) return strut_row_avx512::row;
  return is_supported(InstructionSet::avx2) ? strut_row_avx2::row : strut_row_sse2::row;
}

}  // namespace meso::implicit
