// SPDX-License-Identifier: Apache-2.0
#pragma once
// An STL file as a solid with one plane face per facet. Private.

#include <optional>

#include "meso/resource/resource.hpp"
#include "solid_context.hpp"

namespace meso::brep {

/// In the file's own unit, not yet checked to be closed. Facets are joined where their corners are equal, bit for bit;
/// one solid per connected surface.
[[nodiscard]] std::optional<Solids> read_stl_solids(const Resource& file, ElementId where, const SolidContext& context);

}  // namespace meso::brep
