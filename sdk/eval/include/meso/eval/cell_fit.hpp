// SPDX-License-Identifier: Apache-2.0
#pragma once
// Whether the cells of a pattern stand as far apart as they are long. A lattice that does not is seldom meant, and the
// usual cause is a spacing in another unit, or none.
//
//   warn_of_misfits(evaluation, sink);
//
// Looks at one cell and its steps. Stateless.

#include "meso/eval/evaluation.hpp"

namespace meso::eval {

/// CELLS_COINCIDE for patterns whose index does not move the cells; CELLS_OVERLAP and CELLS_APART, warnings too, for
/// beams in boxes that do. Of patterns that cut holes, or stand beside another pattern, gaps are not told.
void warn_of_misfits(const Evaluation& evaluation, DiagnosticSink& sink);

}  // namespace meso::eval
