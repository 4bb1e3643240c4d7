// SPDX-License-Identifier: Apache-2.0
#pragma once
// How exact the values of external fields must be for the signs of the whole to be right.

#include <vector>

#include "graph.hpp"

namespace meso::implicit {

/// For each of graph.externals(): values beyond the band count by their sign only (ExternalField::prepare). Only the
/// root's sign is asked for, so with root = external - 0.3 the band is 0.3. Infinity: its value matters everywhere.
[[nodiscard]] std::vector<double> external_bands(const Graph& graph, Graph::Id root);

}  // namespace meso::implicit
