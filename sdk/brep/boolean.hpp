// SPDX-License-Identifier: Apache-2.0
#pragma once
// Booleans that are right or refused. OpenCASCADE's can be wrong without a word, so every result must add up: the
// pieces that an operation splits its arguments into have the arguments' volumes, the result has the volume of the
// pieces it is made of, points within each piece lie in the arguments it came from and in no other, every shell is
// closed and every edge known to 1e-4 mm. One intersection serves the operation and its check. Private.
//
// Arguments are Solids: outward oriented, and disjoint within one set. A failed check is tried again with a fuzzy
// tolerance of 1e-6 and 1e-5 mm, then reported as GEOMETRY_BOOLEAN. A stop asked for by the run options is CANCELLED or
// LIMIT_TIME. Cost: about 0.05 s per solid that meets others, and 0.1 ms per face for the check.

#include <TopTools_DataMapOfShapeListOfShape.hxx>
#include <optional>

#include "solid_context.hpp"

namespace meso::brep {

/// By the exact face integrals; negative if the faces look inwards.
[[nodiscard]] double volume_of(const TopoDS_Shape& shape);
/// A box that contains the shape, a little larger than needed.
[[nodiscard]] Box3 box_of(const TopoDS_Shape& shape);

struct EdgeUses {
  std::size_t free = 0;      ///< used once: the shell is open
  std::size_t multiple = 0;  ///< used more than twice
};
[[nodiscard]] EdgeUses edge_uses(const TopoDS_Shape& shape);

/// The solids of any shape, each outward oriented.
[[nodiscard]] Solids solids_of(const TopoDS_Shape& shape);

/// The union of solids that may overlap. Those whose boxes keep apart are left alone.
[[nodiscard]] std::optional<Solids> fuse(const Solids& operands, ElementId where, const SolidContext& context);
[[nodiscard]] std::optional<Solids> common(const Solids& a, const Solids& b, ElementId where,
                                           const SolidContext& context);
/// `tools` may overlap each other. Many are cut in slabs: see slabs.hpp.
[[nodiscard]] std::optional<Solids> cut(const Solids& base, const Solids& tools, ElementId where,
                                        const SolidContext& context);
/// Of tools in clusters that keep clear of each other.
[[nodiscard]] std::optional<Solids> cut(const Solids& base, const std::vector<Solids>& clusters, ElementId where,
                                        const SolidContext& context);

/// The faces, edges and vertices of a base that a cut has changed, and what is left of each.
using CutImages = TopTools_DataMapOfShapeListOfShape;
/// All tools in one boolean.
[[nodiscard]] std::optional<Solids> cut_at_once(const Solids& base, const Solids& tools, ElementId where,
                                                const SolidContext& context, CutImages* images = nullptr);

}  // namespace meso::brep
