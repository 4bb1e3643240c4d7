// SPDX-License-Identifier: Apache-2.0
#pragma once
// What realising and sampling a part have in common. Private.

#include <optional>
#include <string_view>

#include "meso/brep/lattice_body.hpp"
#include "meso/brep/realise.hpp"
#include "solid_context.hpp"

namespace meso::brep {

/// The part with that id, or the only part; nothing with a diagnostic.
[[nodiscard]] const Part* chosen_part(const eval::Evaluation& evaluation, std::optional<std::string_view> part_id,
                                      DiagnosticSink& sink);

/// True for the operations on a body that a repeated template can answer: what is left of it, or all where nothing was.
[[nodiscard]] bool may_be_lattice(const Apply& apply, const Solids& body);

[[nodiscard]] std::optional<Solids> macrostructure_solids(const eval::Evaluation& evaluation, const std::string& id,
                                                          const SolidContext& context);

[[nodiscard]] std::optional<MeshFineness> fineness(const RealiseOptions& options);

/// Solids as plain values, meshed if the options say so. May throw Standard_Failure.
[[nodiscard]] std::optional<Body> to_body(const Solids& solids, const RealiseOptions& options, DiagnosticSink& sink);
/// What becomes of edges that touch, or are short: OpenCASCADE's mending divides the ones and takes out the others.
enum class Edges { mended, as_they_are };
/// And back, for steps and parts that go on from a body that was put together without booleans. Nothing where they hold
/// another volume than the body. May throw Standard_Failure.
[[nodiscard]] std::optional<Solids> solids_from(const Body& body, Edges edges);

}  // namespace meso::brep
