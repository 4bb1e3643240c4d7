// SPDX-License-Identifier: Apache-2.0
#pragma once
// One large cut as many small ones. OpenCASCADE's cut takes longer for each tool the more there are. Tools that keep
// apart may be cut one after the other, so they are dealt out to slabs along an axis, each slab is cut from a copy of
// the body alone, and what all of them leave of each face and edge of the body is put together. No plane between the
// slabs is needed: the body is not divided, and the result has the faces that one cut would make.
//
//   auto left = cut_in_slabs(body, clusters, 256, where, context);   // clusters keep apart, their tools need not
//
// Each small cut is checked as every boolean is; the whole is closed and has the volume that the small ones leave.
// Where that fails, or everything is one cluster, there is one cut. Slabs run on as many threads as the run options
// allow, and the result does not depend on it. Errors: as `cut`. Cost: 5 ms a tool, and a cut of the body's faces per
// slab. Private.

#include <optional>

#include "solid_context.hpp"

namespace meso::brep {

[[nodiscard]] std::optional<Solids> cut_in_slabs(const Solids& base, const std::vector<Solids>& clusters,
                                                 std::size_t slab_tools, ElementId where, const SolidContext& context);

}  // namespace meso::brep
