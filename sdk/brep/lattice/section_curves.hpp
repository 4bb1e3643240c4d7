// SPDX-License-Identifier: Apache-2.0
#pragma once
// The edges along which faces of a cell and of a body cut each other, fitted to both surfaces again. Private.
//
// The ends are moved onto the old edges that they divide, so that neighbours that cut a common wall agree, and the
// curves onto both surfaces (curve_fit.hpp). Where that does not converge (surfaces that touch, an edge on an edge)
// everything stays as it was. Writes to the edges.

#include <vector>

#include "occt.hpp"

namespace meso::brep {

/// An edge that one face of the cell and one of the body share.
struct SectionEdge {
  TopoDS_Edge edge;
  TopoDS_Face of_cell, of_body;  ///< pieces that it bounds
};

/// An edge at an end of sections that is a piece of one of the cell or of the body.
struct DividedEdge {
  TopoDS_Edge edge;
  bool of_cell = false, of_body = false;  ///< both: where it is must not change
};

/// Lengths below 1e-7 of `size` do not count.
void fit_sections(const std::vector<SectionEdge>& sections, const std::vector<DividedEdge>& divided, double size);

}  // namespace meso::brep
