// SPDX-License-Identifier: Apache-2.0
#pragma once
// The union of beams whose struts meet each other beyond the balls of their nodes. Private.
//
// A strut that runs free somewhere between its nodes has one face, from what it ends at around the one node to what it
// ends at around the other: arcs of circles on balls, arcs of ellipses between cylinders of one radius, elsewhere
// curves laid through points of both surfaces. No boolean is needed.

#include <optional>
#include <string>

#include "beam_graph.hpp"
#include "meso/brep/lattice_body.hpp"

namespace meso::brep {

/// Nothing, and why, where struts meet in other ways. May throw Standard_Failure. Cost: about 0.7 ms a strut.
[[nodiscard]] std::optional<Body> mitred_body(const BeamGraph& graph, const LatticeOptions& options,
                                              SnappedRadii& snapped, std::string& why);

/// Is there between any two nodes something of a strut to be seen that meets no other? May be true where mitred_body
/// refuses.
[[nodiscard]] bool struts_run_free(const BeamGraph& graph, const RunOptions& run);

}  // namespace meso::brep
