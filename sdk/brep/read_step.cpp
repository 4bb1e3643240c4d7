// SPDX-License-Identifier: Apache-2.0
#include "meso/brep/read_step.hpp"

#include "boolean.hpp"
#include "import_solid.hpp"
#include "shape_to_body.hpp"

namespace meso::brep {

std::optional<Body> read_step(const Resource& file, const ReadStepOptions& options, const RunOptions& run,
                              DiagnosticSink& sink) {
  const SourceMap source(file.name().string(), {});
  const auto solids = import_solids({.file = file}, {}, {}, {.source = source, .run = run, .sink = sink},
                                    options.may_cross ? Crossing::read : Crossing::refused);
  if (!solids) return std::nullopt;
  TopoDS_Compound all;
  BRep_Builder builder;
  builder.MakeCompound(all);
  for (const TopoDS_Shape& solid : *solids) builder.Add(all, solid);
  std::optional<double> deflection = options.deflection_mm;
  if (options.relative_deflection) {
    const Box3 box = box_of(all);
    deflection = *options.relative_deflection * norm(box.max - box.min);
  }
  ShapeToBodyOptions to_body;
  if (deflection) to_body.mesh = MeshTolerance{.deflection_mm = *deflection, .angle = options.angle_rad};
  if (!to_body.mesh || !options.mesh_may_fail) return shape_to_body(all, to_body, sink);
  DiagnosticSink of_mesh;
  auto body = shape_to_body(all, to_body, of_mesh);
  return body ? std::move(body) : shape_to_body(all, {}, sink);
}

}  // namespace meso::brep
