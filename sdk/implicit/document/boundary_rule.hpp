// SPDX-License-Identifier: Apache-2.0
#pragma once
// Does a cell lie inside a body, or meet it? Private.

#include <optional>

#include "meso/eval/evaluation.hpp"
#include "meso/implicit/field.hpp"

namespace meso::implicit {

struct BoundaryQuestion {
  bool inside = true;    ///< else: does it meet the body?
  double clearance = 0;  ///< inside by at least this much
};

/// `region`: the cell's box or volume element; `frame` puts it into the world. `own`: the cell's body in the world
/// where the rule asks for that, else null. Regions are halved until the body's boundary is too far away to matter, or
/// down to a sixteenth.
[[nodiscard]] bool answer(const BoundaryQuestion& question, const Field& body, const eval::Shape& region,
                          const Affine& frame, const Field* own);

}  // namespace meso::implicit
