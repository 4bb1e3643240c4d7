// SPDX-License-Identifier: Apache-2.0
#pragma once
// Balls and struts that meet in circles as an exact body: one face for each strut, one or more for each ball, no
// booleans. Private.
//
//   auto body = beam_graph_body(joints, {.mesh = MeshFineness{0.05}}, sink);
//
// Each connected set of beams is one solid of one shell, without voids: faces of a ball hang together by its struts.
// `pieces_volume` is the sum of balls without caps and of cones between circles, computed apart from the faces.
//
// Cost: about 10 us and 2 KiB a strut, and as much again for its triangles; LIMIT_MEMORY if that is over the budget.
// May throw Standard_Failure. Thread rule: pure.

#include <optional>

#include "beam_graph_joints.hpp"
#include "meso/brep/body.hpp"
#include "meso/brep/lattice_body.hpp"

namespace meso::brep {

[[nodiscard]] std::optional<Body> beam_graph_body(const Joints& joints, const LatticeOptions& options,
                                                  DiagnosticSink& sink);

}  // namespace meso::brep
