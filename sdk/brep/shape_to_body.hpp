// SPDX-License-Identifier: Apache-2.0
#pragma once
// OpenCASCADE solids to a Body. Private to the room: the argument is an OpenCASCADE shape.
//
//   DiagnosticSink sink;
//   std::optional<Body> body = shape_to_body(shape, {.mesh = MeshTolerance{.deflection_mm = 0.05}}, sink);
//
// Every solid of the shape becomes a Solid; faces and shells outside solids are ignored, a shape without a solid is
// GEOMETRY_NO_SOLID. A shell that occurs several times under different locations is stored once and placed. Lengths
// keep their unit (millimetres). Cost: about 0.1 ms a face, plus OpenCASCADE's mesher where a mesh is asked for.
// Errors: GEOMETRY_* into the sink; nothing of OpenCASCADE's is thrown.

#include <optional>

#include "face_mesh.hpp"
#include "meso/base/diagnostic.hpp"
#include "meso/brep/body.hpp"
#include "occt.hpp"

namespace meso::brep {

struct ShapeToBodyOptions {
  std::optional<MeshTolerance> mesh{};
};

[[nodiscard]] std::optional<Body> shape_to_body(const TopoDS_Shape& shape, const ShapeToBodyOptions& options,
                                                DiagnosticSink& sink);

/// One closed shell as a template in the shell's own frame (its location is ignored). Throws Standard_Failure.
[[nodiscard]] Template shell_to_template(const TopoDS_Shell& shell, const std::optional<MeshTolerance>& mesh);

}  // namespace meso::brep
