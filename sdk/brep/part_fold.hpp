// SPDX-License-Identifier: Apache-2.0
#pragma once
// The left fold of a part, and of the parts that it is made of: each of those is made once, however often it stands.
// Private.
//
//   PartFold fold(evaluation, options, sink);
//   if (auto folded = fold.outermost(part)) ...   // a repeated template, or solids
//
// Errors: as `realise`. May throw Standard_Failure.

#include <map>

#include "lattice/cell_selection.hpp"
#include "lattice/clipped_lattice.hpp"
#include "meso/brep/realise.hpp"
#include "meso/eval/evaluation.hpp"
#include "realise_fold.hpp"

namespace meso::brep {

/// A body while the fold goes on: solids, or, after the last step, what was put together without them.
struct FoldedPart {
  Solids solids;
  double pieces_volume = 0;  ///< of what they were put together from; 0: not known
  std::optional<Body> body;
  CellCounts counts;
  ClipCounts clip;
  std::string way = "direct";  ///< the last that was needed
};

[[nodiscard]] CellCounts sum_of(const CellCounts& a, const CellCounts& b);
/// Of an operand: fragments are those of a part's own cuts.
[[nodiscard]] CellCounts without_fragments(CellCounts counts);

class PartFold final : public PartMaker {
 public:
  PartFold(const eval::Evaluation& evaluation, const RealiseOptions& options, DiagnosticSink& sink)
      : evaluation_(evaluation), options_(options), context_{evaluation.checked().source(), options.run, sink, this} {}
  PartFold(const PartFold&) = delete;
  PartFold& operator=(const PartFold&) = delete;

  [[nodiscard]] std::optional<FoldedPart> outermost(const Part& part) { return fold(part, true); }
  [[nodiscard]] const Solids* solids_of(const Part& part) override;
  [[nodiscard]] const eval::CellStream* only_cells_of(const Part& part) override;
  [[nodiscard]] const eval::BeamsShape* beams_in(const eval::CellStream& cells) override;

 private:
  /// A part that others are made of. It has no parameters, so that it is the same wherever it stands.
  struct Operand {
    Solids solids;
    CellCounts counts;
  };

  struct Beams {
    eval::BeamsShape shape;
    CellCounts counts;
  };

  std::optional<FoldedPart> fold(const Part& part, bool is_outermost);
  /// Beams of several steps, as one graph.
  bool try_beams(FoldedPart& state, const Part& part, bool stays_body);
  /// The body of `made` becomes that of `state`, or its solids. False: not worth it, or not possible.
  bool take(FoldedPart& state, FoldedPart made, bool stays_body);
  bool step(FoldedPart& state, const Part& part, const Apply& apply, bool stays_body);
  /// Nothing where `is_done` says that `state` has the result already, and after an error.
  std::optional<FoldStep> apply_pattern(FoldedPart& state, const Part& part, const FoldContext& context,
                                        bool stays_body, bool& is_done);
  std::optional<FoldStep> apply_beams(FoldedPart& state, const eval::CellStream& cells, const FoldContext& context);
  std::optional<FoldStep> apply_part(FoldedPart& state, const FoldContext& context);
  /// The part that a step applies, where it puts it; what was placed to make it is added to `counts`.
  std::optional<Solids> placed_operand(const Apply& apply, CellCounts& counts);
  bool misses(const FoldStep& step, const FoldedPart& state, const Part& part, const eval::CellStream& cells,
              const Apply& apply);
  /// Step `at`, a pattern, and all after it at once; `state` has not changed where that does not do.
  bool try_joined(FoldedPart& state, const Part& part, std::size_t at);
  bool try_template(FoldedPart& state, const Part& part, const eval::CellStream& cells, const FoldContext& context,
                    bool stays_body, const FusedLimit& fused);
  struct LatticeWay {
    std::optional<MeshFineness> mesh;
    FusedLimit fused;
  };
  bool try_lattice(FoldedPart& state, const eval::CellStream& cells, const FoldContext& context,
                   const std::string& part, const LatticeWay& way);
  bool try_beam_graph(FoldedPart& state, const eval::CellStream& cells, const FoldContext& context,
                      const std::optional<MeshFineness>& mesh);
  const Operand* operand_of(const Part& part);
  /// Is a template to be tried only where the beams are no graph?
  bool graph_comes_first(const eval::CellStream& cells);
  const eval::BeamsShape* beams_of(const Part& part);
  bool add_beams(Beams& all, const Apply& apply);
  bool add_beams(Beams& all, const eval::CellStream& cells);
  /// Null where the cells are something else.
  const Part* part_in_cells(const Pattern& pattern) const;
  /// What was placed to make a part that stands in cells.
  CellCounts counts_inside(const Part& part);

  const eval::Evaluation& evaluation_;
  const RealiseOptions& options_;
  SolidContext context_;
  double done_ = 0;  ///< share of the steps of the outermost part that is made
  std::map<const Part*, Operand> operands_;
  std::map<const Part*, std::optional<eval::CellStream>> only_cells_;
  std::map<const Part*, std::optional<Beams>> beams_;
};

}  // namespace meso::brep
