// SPDX-License-Identifier: Apache-2.0
#pragma once
// Keeps the float rows of a field from rounding to zero or infinity, where no edge would tell how far its crossing is.

#include "graph.hpp"
#include "meso/implicit/grid.hpp"

namespace meso::implicit {

/// `root`, or it times a power of two if floats cannot hold what the term usually is in the box. That changes neither
/// a sign nor where on an edge the field is zero.
[[nodiscard]] Graph::Id fit_to_floats(Graph& graph, Graph::Id root, const Term& term, const Grid& grid);

}  // namespace meso::implicit
