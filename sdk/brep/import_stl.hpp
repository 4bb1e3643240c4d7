// SPDX-License-Identifier: Apache-2.0
#pragma once
// An STL file as a solid with one plane face per facet. Private.

#include <filesystem>
#include <optional>

#include "solid_context.hpp"

namespace meso::brep {

/// In the file's own unit, not yet checked to be closed. Facets are joined where their corners are equal, bit for bit;
/// one solid per connected surface.
[[nodiscard]] std::optional<Solids> read_stl_solids(const std::filesystem::path& file, ElementId where,
                                                    const SolidContext& context);

}  // namespace meso::brep
