// SPDX-License-Identifier: Apache-2.0
#pragma once
// Joins the pieces into which box walls cut a face: a ball on a corner of the box is one sphere, not eight octants.
// Private.

#include "lattice/quotient.hpp"

namespace meso::brep {

/// Fills `naturals` and `part_of` for the cells of kind 0. Pieces on B-spline surfaces and tori stay as they are, and
/// so do faces that never end (a strut that runs through every cell).
void find_natural_faces(Quotient& quotient);

}  // namespace meso::brep
