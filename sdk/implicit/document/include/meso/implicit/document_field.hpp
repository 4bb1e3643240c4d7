// SPDX-License-Identifier: Apache-2.0
#pragma once
// A part of a document as a field: what compile() and contour() make a mesh of.
//
//   const auto part = field_of_part(*evaluation, *evaluation->find_part("lightBeam"), {.imports = read_mesh}, sink);
//   const auto source = compile(part->field.term(), grid);
//
// Every body, pattern, mapping and rule of the document is understood, but for conformal mapping in coordinate systems
// whose inverse is not known here, and of bodies other than implicit ones, boxes, beams and parts cut to their box.
// Bodies that touch are joined: operands of unions and cells grow by `seam` (R-5.12.7 decides boundaries no finer).
// Boundary rules look at the 16 x 16 x 16 parts of each cell that the left operand's boundary may cross.
//
// Millimetres, in the part's frame. Errors: an empty optional and what evaluation reports, CONFORMAL_*,
// IMPLICIT_UNKNOWN_SURFACE, GEOMETRY_FRAGMENTS, LIMIT_*.
// Cost: a lattice of translates one period, whatever its size; other patterns about 250 bytes a strut.
// Thread rule: pure.

#include <functional>
#include <optional>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/base/triangle_mesh.hpp"
#include "meso/eval/evaluation.hpp"
#include "meso/implicit/field.hpp"

namespace meso::implicit {

/// Bodies closer than this are one, in millimetres.
inline constexpr double seam = 1e-6;

/// The triangles of a foreign file in the file's own coordinates: before ImportShape's scale and transform. Nothing
/// after an error. Called once for each file.
using ImportMeshReader = std::function<std::optional<TriangleMesh>(const eval::ImportShape&, DiagnosticSink&)>;

struct DocumentFieldOptions {
  ImportMeshReader imports{};
  RunOptions run{};
  /// Of the samples that will be taken; loose fragments are told apart at this spacing. 0: from the smallest feature.
  double spacing_mm = 0;
};

struct PartField {
  Field field;
  /// The thinnest strut, ball or cell wall as far as the document's numbers tell; infinity if nothing does.
  double smallest_feature_mm = HUGE_VAL;
  /// How far apart samples may be for implicit cells to hold their stated densities within 0.2 %; infinity if none is
  /// stated.
  double density_spacing_mm = HUGE_VAL;
  std::uint64_t cells_placed = 0, cells_kept = 0;
  std::uint64_t fragments = 0;  ///< dropped
};

[[nodiscard]] std::optional<PartField> field_of_part(const eval::Evaluation& evaluation, const Part& part,
                                                     const DocumentFieldOptions& options, DiagnosticSink& sink);

/// The body moved by any map with an inverse; distances stay lower bounds.
[[nodiscard]] Field moved(const Field& field, const Affine& map);

}  // namespace meso::implicit
