// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a CellStream holds: the compiled pattern, its size, the bodies' expressions.

#include <memory>
#include <mutex>
#include <vector>

#include "body.hpp"
#include "meso/eval/evaluation.hpp"
#include "pattern_program.hpp"
#include "strut_pairs.hpp"

namespace meso::eval {

/// Balls that need all cells of a pattern: made by the first cell that asks for one.
struct LazyPoleBalls {
  std::once_flag once;
  std::optional<PoleBalls> balls;
  std::vector<Diagnostic> told;  ///< why there are none
};

struct CellStream::Impl {
  std::shared_ptr<const PatternProgram> program;
  BodyTable body;
  std::uint64_t size = 0;
  std::shared_ptr<const CoordinateFrame> frame_mm;
  mutable LazyPoleBalls poles;

  [[nodiscard]] const EvaluationData& data() const { return *program->evaluation; }
  [[nodiscard]] bool is_conformal() const { return program->mapping == CellMapping::conformal; }
};

/// Nothing if something was reported; too many cells are reported here.
[[nodiscard]] std::shared_ptr<const CellStream::Impl> make_cell_stream(
    const std::shared_ptr<const EvaluationData>& data, const Pattern& pattern, DiagnosticSink& sink);

}  // namespace meso::eval
