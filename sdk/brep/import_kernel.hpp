// SPDX-License-Identifier: Apache-2.0
#pragma once
// Files that OpenCASCADE itself reads, beside STEP: its own BREP (text) and IGES. Private.
//
// Both readers trust what they read, so a file is looked at before: BREP must begin and end as one and hold no number
// that is none, IGES must have its closing line. What was read is not yet checked to be closed.

#include <mutex>
#include <optional>

#include "meso/resource/resource.hpp"
#include "solid_context.hpp"

namespace meso::brep {

/// OpenCASCADE's readers keep their settings in process-wide variables, and write to standard output.
[[nodiscard]] std::mutex& reader_mutex();

/// In the file's own unit, which it does not state.
[[nodiscard]] std::optional<Solids> read_brep_solids(const Resource& file, ElementId where,
                                                     const SolidContext& context);

/// In millimetres. Solids as they are; loose faces, as most programs write them, are sewn together where their edges
/// are within 1e-5 of the model's size, and closed surfaces become solids, those within others cavities.
[[nodiscard]] std::optional<Solids> read_iges_solids(const Resource& file, ElementId where,
                                                     const SolidContext& context);

}  // namespace meso::brep
