// SPDX-License-Identifier: Apache-2.0
#pragma once
// An operation of one to eight numbers, chosen at run time; the arithmetic is expr::apply's.

#include <span>

#include "meso/expr/expression.hpp"

namespace meso::implicit {

/// REQUIRES: as many operands as `op` takes; no leaf and no skip.
[[nodiscard]] double apply_operation(expr::Op op, std::span<const double> operands);

}  // namespace meso::implicit
