// SPDX-License-Identifier: Apache-2.0
#pragma once
// What is told of a pattern's step, where its author would edit the document: a lattice that cannot be repeated at the
// start of its loops, which moves it, and not at the beams of its cell, which are well. Private.
//
//   StepTelling telling(cells, context);
//   auto made = apply_cells(body, cells, telling.context(), counts);
//   telling.pass_on();

#include <functional>

#include "meso/eval/evaluation.hpp"
#include "realise_fold.hpp"

namespace meso::brep {

class StepTelling {
 public:
  /// Both are kept by reference. `is_cut`: the cells meet a body.
  StepTelling(const eval::CellStream& cells, const FoldContext& of_step, bool is_cut)
      : cells_(cells),
        of_step_(of_step),
        is_cut_(is_cut),
        solid_{of_step.solid.source, of_step.solid.run, apart_, of_step.solid.parts} {}
  StepTelling(const StepTelling&) = delete;
  StepTelling& operator=(const StepTelling&) = delete;

  /// That of the step, with a sink of its own.
  [[nodiscard]] FoldContext context() const {
    return {solid_, of_step_.apply, of_step_.clearance, of_step_.max_boolean_solids, of_step_.done};
  }
  /// Of errors about booleans: what was tried before.
  void add_reason(std::string reason) { reason_ = std::move(reason); }
  /// To the sink of the step, once; of all, what is `wanted`.
  void pass_on(const std::function<bool(const Diagnostic&)>& wanted = {}) const;

 private:
  [[nodiscard]] Diagnostic placed(Diagnostic d) const;

  const eval::CellStream& cells_;
  const FoldContext& of_step_;
  bool is_cut_;
  std::string reason_;
  DiagnosticSink apart_;
  SolidContext solid_;
};

/// Do the struts of the cells meet beyond the balls of their nodes, so that automatic balls would help?
[[nodiscard]] bool would_gain_from_balls(const eval::CellStream& cells, const SolidContext& context);

}  // namespace meso::brep
