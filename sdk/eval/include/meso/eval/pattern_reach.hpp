// SPDX-License-Identifier: Apache-2.0
#pragma once
// Whether the cells of a pattern are there at all, and where the body is: faults that would otherwise only show as a
// part without holes.
//
//   if (!check_reach(evaluation, *cells, apply, part, box_of_body_mm, may_reach, sink))
//     return std::nullopt;  // FIELD_MISSES_PART
//
// Each looks at cells only until one is found. Stateless.

#include <functional>

#include "meso/eval/evaluation.hpp"

namespace meso::eval {

/// Warns with PATTERN_KEEPS_NONE where <when> drops every cell. False: an expression failed or the run was stopped.
[[nodiscard]] bool check_keeps_any(const Evaluation& evaluation, const CellStream& cells, DiagnosticSink& sink);

/// False only where an engine is sure that the cell is clear of the body.
using MayReach = std::function<bool(const PlacedCell&)>;

/// where cells at records are to cut a body, one of them at least reaches it. Of cells that are placed
/// otherwise, none may: that is a warning for a difference (PATTERN_MISSES_PART). An intersection with several cells
/// warns where the body is smaller than each of those there (BODY_WITHIN_CELL), a difference where there are no cells
/// (PATTERN_KEEPS_NONE). Also check_keeps_any(). `body_mm` holds
/// the body so far; empty: there is none yet. `may_reach` is asked for cells whose boxes touch that; an engine that
/// finds out later leaves it empty and uses must_reach(). False after an error.
[[nodiscard]] bool check_reach(const Evaluation& evaluation, const CellStream& cells, const Apply& apply,
                               const Part& part, const Box3& body_mm, const MayReach& may_reach, DiagnosticSink& sink);

/// Is this step one of those that is about?
[[nodiscard]] bool must_reach(const CellStream& cells, const Apply& apply);
/// FIELD_MISSES_PART.
void report_no_reach(const Evaluation& evaluation, const CellStream& cells, const Part& part, DiagnosticSink& sink);

/// GEOMETRY_EMPTY, and where the cells of its patterns are, or that there are none.
[[nodiscard]] Diagnostic empty_part(const Evaluation& evaluation, const Part& part);

}  // namespace meso::eval
