// SPDX-License-Identifier: Apache-2.0
#pragma once
// Carries out a program: its words become one field.
//
//   const auto field = sdf::build_field(*program, load_mesh, sink);
//   field->bounds()   // what `-b` would be if it were not given, but for unbounded sides

#include <functional>
#include <memory>
#include <optional>

#include "meso/implicit/field.hpp"
#include "meso/sdf/program.hpp"

namespace meso::sdf {

/// The distance to the mesh in a file, or nothing, with a diagnostic. One without a place gets that of the word.
using MeshLoader =
    std::function<std::shared_ptr<const implicit::ExternalField>(const std::string& path, DiagnosticSink& sink)>;

/// A file named twice is loaded once.
[[nodiscard]] std::optional<implicit::Field> build_field(const Program& program, const MeshLoader& load_mesh,
                                                         DiagnosticSink& sink);

/// The box that the program means for this field: -b, else the field's own, unbounded sides at -1 and 1. Nothing if the
/// field certainly has no inside. An empty or inverted box is SDF_BOX.
struct ProgramBox {
  Box3 box;
  bool certainly_empty = false;
};
[[nodiscard]] Box3 corner_and_size(const Box3& box);  ///< max = min + size
[[nodiscard]] std::optional<ProgramBox> box_of(const Program& program, const implicit::Field& field,
                                               DiagnosticSink& sink);

}  // namespace meso::sdf
