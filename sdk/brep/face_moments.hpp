// SPDX-License-Identifier: Apache-2.0
#pragma once
// The exact integrals and the box of one OpenCASCADE face, by quadrature on its own surface and pcurves. Private.

#include "meso/brep/body.hpp"
#include "occt.hpp"

namespace meso::brep {

/// Integrals over `face`, outward as its orientation says, about the origin. Relative error about 1e-12 where the
/// pcurves are exact; else what the pcurves miss (their tolerance times the edge length). Cost: 30 points of each
/// smooth span of an edge at least; on surfaces that are not elementary, ten and more of the surface for each (a few ms
/// for a B-spline surface). Throws Standard_Failure as OCCT does.
[[nodiscard]] FaceMoments face_moments(const TopoDS_Face& face);

/// A box that contains the exact face: tight for planes, quadrics and tori; for B-spline surfaces as OCCT finds it.
[[nodiscard]] Box3 face_box(const TopoDS_Face& face);

}  // namespace meso::brep
