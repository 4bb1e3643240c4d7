// SPDX-License-Identifier: Apache-2.0
#pragma once
// A Body as an OpenCASCADE shape, for .brep files and for general booleans on bodies of up to some 100 000 faces.
// Private.
//
//   std::optional<TopoDS_Shape> shape = to_shape(body, sink);
//
// One solid, or a compound of several. Instances of a face share surfaces only in form: every instance has its own, as
// OpenCASCADE cannot share edges between located faces. Pcurves are projected, so the cost is a few ms a curved face.
// Errors: GEOMETRY_KERNEL.

#include <optional>

#include "meso/base/diagnostic.hpp"
#include "meso/brep/body.hpp"
#include "occt.hpp"

namespace meso::brep {

[[nodiscard]] std::optional<TopoDS_Shape> to_shape(const Body& body, DiagnosticSink& sink);

/// The same where the body is known to be right: nothing is divided or left out, however closely edges pass each other.
[[nodiscard]] std::optional<TopoDS_Shape> to_shape_as_is(const Body& body, DiagnosticSink& sink);

}  // namespace meso::brep
