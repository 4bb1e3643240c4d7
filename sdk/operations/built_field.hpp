// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a document builds, as one field: the start of every mesh and volume of the implicit engine. Private.

#include "meso/implicit/document_field.hpp"
#include "meso/operations/convert.hpp"
#include "meso/sdf/program.hpp"

namespace meso::operations {

/// What is built: one field, and what is known of it.
struct BuiltField {
  implicit::Field field;
  std::string names;                ///< of the parts
  const Part* only_part = nullptr;  ///< where it is one
  double smallest_feature_mm = HUGE_VAL;
  double density_spacing_mm = HUGE_VAL;
  brep::CellCounts cells;
  std::optional<sdf::Program> words{};  ///< of a document that is words
};

/// The union of what is built; one that is empty is reported. Nothing: reported.
[[nodiscard]] std::optional<BuiltField> built_field(const eval::Evaluation& evaluation, const MakeOptions& options,
                                                    DiagnosticSink& sink);

/// What is told where nothing is left of it.
[[nodiscard]] Diagnostic told_of_empty(const BuiltField& built, const eval::Evaluation& evaluation);

/// Shares beyond 0 and 1. A weight's clamp() stands in the document.
void warn_of_clamped(const BuiltField& built, const Box3& box, DiagnosticSink& sink);

}  // namespace meso::operations
