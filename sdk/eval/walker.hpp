// SPDX-License-Identifier: Apache-2.0
#pragma once
// Runs a compiled pattern: steps from cell to cell in the normative order and gives each its placement. Holds one cell
// at a time; one walker per thread.

#include <optional>
#include <span>
#include <vector>

#include "expression_program.hpp"
#include "meso/eval/evaluation.hpp"
#include "pattern_program.hpp"

namespace meso::eval {

class Walker {
 public:
  Walker(const PatternProgram& program, DiagnosticSink& sink);

  /// Number of cells; stops counting beyond `limit` (the result is then larger than it). Nothing if an expression
  /// failed.
  [[nodiscard]] std::optional<std::uint64_t> count(std::uint64_t limit);
  /// Of the last count: else there are more cells than it says.
  [[nodiscard]] bool is_exact() const { return !is_at_least_; }

  /// Visits the kept cells with ordinals in [first, last). REQUIRES: last <= the number of cells.
  [[nodiscard]] bool visit(std::uint64_t first, std::uint64_t last, const CellStream::Visitor& visitor);
  /// True after the visitor has answered false.
  [[nodiscard]] bool ended() const { return ended_; }

 private:
  [[nodiscard]] std::size_t loops() const { return program_.loops.size(); }
  [[nodiscard]] Report report(std::size_t known_indices) const;

  // Loops. False: something was reported.
  [[nodiscard]] bool evaluate(const BoundExpression& expression, double& value, std::size_t known_indices);
  [[nodiscard]] bool begin_count(std::size_t loop);
  [[nodiscard]] bool begin_places(std::size_t loop);
  [[nodiscard]] bool begin_direction(std::size_t loop);
  [[nodiscard]] bool move_to(std::size_t loop, std::int64_t index);
  /// where the cell ends that begins at q.
  [[nodiscard]] bool end_of_sized(std::size_t loop, double q, double& end);
  [[nodiscard]] bool move_to_record(const LoopProgram& program);
  [[nodiscard]] bool seek(std::uint64_t ordinal);
  [[nodiscard]] bool next();
  /// True if every index of `loop` holds equally many cells, and so on inwards.
  [[nodiscard]] bool is_product(std::size_t loop) const;
  [[nodiscard]] std::optional<std::uint64_t> count_from(std::size_t loop, std::uint64_t limit);

  // The cell where the loops stand.
  void compile();
  [[nodiscard]] bool assign(const Assign& assign, std::size_t position);
  struct Motion {
    Affine map;
    bool drops = false;
  };
  [[nodiscard]] bool place();
  [[nodiscard]] bool run(const Statement& statement, std::size_t position);
  [[nodiscard]] bool check_distances();
  [[nodiscard]] bool fill_steps();
  [[nodiscard]] Vec3 vector(std::uint32_t slot) const { return {slots_[slot], slots_[slot + 1], slots_[slot + 2]}; }
  [[nodiscard]] bool orientation(const Orient& orient, Motion& result);
  [[nodiscard]] bool motion(const Statement& statement, Motion& result);

  const PatternProgram& program_;
  DiagnosticSink& sink_;
  std::vector<double> slots_;
  std::vector<LoopState> state_;
  std::vector<std::int64_t> index_;
  std::vector<std::optional<ExpressionProgram>> programs_;  ///< per statement, once many cells are asked for
  std::vector<Motion> motions_;                             ///< per statement; of those that move the frame
  int changed_ = constant_level;                            ///< outermost level that moved since the last placed cell
  std::uint64_t counted_ = 0;                               ///< indices that counting has stepped through
  bool is_at_least_ = false;                                ///< the last count stopped before its end
  bool dropped_ = false;
  bool ended_ = false;
  Mat3 turn_, local_;
  Affine frame_;  ///< the cell's, document unit
  std::vector<double> q_;
  PlacedCell cell_;
};

}  // namespace meso::eval
