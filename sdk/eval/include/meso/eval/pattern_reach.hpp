// SPDX-License-Identifier: Apache-2.0
#pragma once
// Whether the cells of a pattern are there at all, and where the body is: faults that would otherwise only show as a
// part without holes.
//
//   if (!check_reach(evaluation, *cells, apply, part, box_of_body_mm, sink))
//     return std::nullopt;  // FIELD_MISSES_PART
//
// Each looks at cells only until one is found. Stateless.

#include "meso/eval/evaluation.hpp"

namespace meso::eval {

/// Warns with PATTERN_KEEPS_NONE where <when> drops every cell. False: an expression failed or the run was stopped.
[[nodiscard]] bool check_keeps_any(const Evaluation& evaluation, const CellStream& cells, DiagnosticSink& sink);

/// where cells at records are to cut a body, one of them at least can touch it. Also check_keeps_any().
/// `body_mm` holds the body so far; empty: there is none yet. False after an error.
[[nodiscard]] bool check_reach(const Evaluation& evaluation, const CellStream& cells, const Apply& apply,
                               const Part& part, const Box3& body_mm, DiagnosticSink& sink);

}  // namespace meso::eval
