// SPDX-License-Identifier: Apache-2.0
#pragma once
// One step of a part's left fold: a body and the cells of a pattern, or another body. Private.

#include <optional>

#include "meso/brep/realise.hpp"
#include "realise_cells.hpp"

namespace meso::brep {

struct FoldStep {
  Solids solids;
  bool used_booleans = false;
  double pieces_volume = 0;  ///< of what the solids were put together from; 0: not known
  bool reaches = true;       ///< one of the cells at least is inside of the body or across its boundary
};

/// What a step needs besides its operands.
struct FoldContext {
  const SolidContext& solid;
  const Apply& apply;
  double clearance = 0;
  std::size_t max_boolean_solids = 600;
  double done = 0;  ///< share of the steps of the part that is made

  [[nodiscard]] ElementId where() const { return apply.id_in_source; }
  /// Cutters, which hardly meet each other, cost a tenth of what solids cost that are united.
  [[nodiscard]] std::size_t most_solids() const;
  /// False, and LIMIT_BOOLEANS, if that many solids are too many to be joined.
  [[nodiscard]] bool within_budget(std::size_t solids) const;
};

/// `body` (empty: nothing) op the cells of the pattern, boundary rule obeyed; counts added. Cells that keep clear of
/// the body's boundary and of each other are placed, the rest is joined by one boolean. May throw Standard_Failure.
[[nodiscard]] std::optional<FoldStep> apply_cells(const Solids& body, const eval::CellStream& cells,
                                                  const FoldContext& context, CellCounts& counts);

/// `body` op `operand`, both outward solids.
[[nodiscard]] std::optional<FoldStep> apply_solids(const Solids& body, const Solids& operand,
                                                   const FoldContext& context);

/// Counts loose fragments and obeys the rule for them; false: the rule is `error`, reported.
[[nodiscard]] bool settle_fragments(Solids& solids, const Solids& before, const FoldContext& context,
                                    const std::string& part, CellCounts& counts);

}  // namespace meso::brep
