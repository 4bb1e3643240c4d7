// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a CellStream holds: the compiled pattern, its size, the bodies' expressions.

#include <memory>

#include "body.hpp"
#include "meso/eval/evaluation.hpp"
#include "pattern_program.hpp"

namespace meso::eval {

struct CellStream::Impl {
  std::shared_ptr<const PatternProgram> program;
  BodyTable body;
  std::uint64_t size = 0;
  std::shared_ptr<const CoordinateFrame> frame_mm;

  [[nodiscard]] const EvaluationData& data() const { return *program->evaluation; }
  [[nodiscard]] bool is_conformal() const { return program->mapping == CellMapping::conformal; }
};

/// Nothing if something was reported; too many cells are reported here.
[[nodiscard]] std::shared_ptr<const CellStream::Impl> make_cell_stream(
    const std::shared_ptr<const EvaluationData>& data, const Pattern& pattern, DiagnosticSink& sink);

}  // namespace meso::eval
