// SPDX-License-Identifier: Apache-2.0
#pragma once
// The topology of a STEP file, from its text alone: OpenCASCADE's reader, which builds the geometry, takes minutes for
// some ten thousand faces. Private.
//
//   std::string fault;
//   if (const auto outline = outline_step(text, run, fault)) outline->free_edges ...
//
// Edges are counted as in brep::Audit: in a closed shell each is used twice, in opposite directions. Entities of solids
// are followed, others are not looked at. Cost: about 10 ns a byte, and half the file in memory.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "meso/base/run_options.hpp"

namespace meso::operations {

struct StepOutline {
  std::uint64_t solids = 0, shells = 0, faces = 0, edges = 0;
  std::uint64_t free_edges = 0, multiple_edges = 0, conflicts = 0, open_loops = 0;
};

/// Nothing, and why: no solid, a shell without faces, none with edges, or an entity that is missing or of an unexpected
/// kind; or, without a reason, stopped.
[[nodiscard]] std::optional<StepOutline> outline_step(std::string_view text, const RunOptions& run, std::string& fault);

/// Number of faces, quickly.
[[nodiscard]] std::uint64_t count_step_faces(std::string_view text);

}  // namespace meso::operations
