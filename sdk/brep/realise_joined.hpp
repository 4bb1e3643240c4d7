// SPDX-License-Identifier: Apache-2.0
#pragma once
// A lattice among the steps of a part, when all other steps are bodies. Those are sets of points: whatever is united,
// taken away or intersected before and after the lattice, the part is (lattice n clip - removed) u added. Private.

#include "realise_fold.hpp"
#include "realise_lattice.hpp"

namespace meso::brep {

/// Step `at` is the pattern, and all after it are such bodies. A lattice that alone is cut by one body is not meant.
[[nodiscard]] bool may_join(const Part& part, std::size_t at, const Solids& before);

struct BodyStep {
  const Apply* apply = nullptr;
  Solids operand;
};
struct JoinedLattice {
  LatticePart part;
  std::size_t fragments = 0;  ///< left loose by all cuts
};

/// The pattern's cells applied to `before` by the step `pattern`, and the bodies after it. Nothing, and no error in the
/// sink, where that is not a lattice that can be made by boxes. May throw Standard_Failure.
[[nodiscard]] std::optional<JoinedLattice> joined_lattice(const Solids& before, const Apply& pattern,
                                                          const eval::CellStream& cells,
                                                          const std::vector<BodyStep>& rest,
                                                          const std::optional<MeshFineness>& mesh,
                                                          const FoldContext& context);

}  // namespace meso::brep
