// SPDX-License-Identifier: Apache-2.0
#pragma once
// Whether the cells of a pattern stand as far apart as they are long, and whether their beams leave anything open. A
// lattice that does not is seldom meant, and the usual cause is a length in another unit, or none.
//
//   warn_of_misfits(evaluation, sink);
//
// Looks at one cell and its steps, a few milliseconds. Stateless.

#include "meso/eval/evaluation.hpp"
#include "meso/eval/shape.hpp"

namespace meso::eval {

/// CELLS_COINCIDE for patterns whose index does not move the cells; CELLS_OVERLAP and CELLS_APART, warnings too, for
/// beams in boxes that do. Of patterns that cut holes, or stand beside another pattern, gaps are not told.
/// BEAMS_FILL_CELL, a warning, for beams of equal cells that fill all of their box, or are as thick as it.
void warn_of_misfits(const Evaluation& evaluation, DiagnosticSink& sink);

/// Do the beams fill the box? What is open and smaller than a 24th of its edges may be missed.
[[nodiscard]] bool fill(const BeamsShape& beams, const BoxShape& box);

}  // namespace meso::eval
