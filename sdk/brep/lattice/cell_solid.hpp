// SPDX-License-Identifier: Apache-2.0
#pragma once
// What the solid is inside one cell box: the primitives of the cell and of the neighbours that reach in, fused and cut
// to the box. Private.

#include <cstdint>
#include <optional>
#include <vector>

#include "meso/base/diagnostic.hpp"
#include "meso/brep/lattice_body.hpp"
#include "occt.hpp"

namespace meso::brep {

/// A unit cell as OpenCASCADE solids. `primitives` is parallel to `solids`, or empty where the solids are not beams.
struct CellShape {
  Box3 box;
  std::vector<TopoDS_Shape> solids;
  std::vector<CellPrimitive> primitives;

  [[nodiscard]] Vec3 size() const { return box.max - box.min; }
  /// Two points closer than this are one.
  [[nodiscard]] double tolerance() const { return 1e-6 * std::fmax(size().x, std::fmax(size().y, size().z)); }
};

[[nodiscard]] std::optional<CellShape> cell_shape(const LatticeCell& cell, DiagnosticSink& sink);

/// The solids that cell + `shift` sends into this one's box and that are not already covered there.
struct Neighbour {
  Index3 shift{};
  std::vector<std::size_t> solids;
};
[[nodiscard]] std::vector<Neighbour> reaching_neighbours(const CellShape& cell);

/// The cell's own solids and those of the neighbours whose bit is set in `present`, inside the box; null if nothing is.
/// Empty, with a diagnostic, if a boolean fails or its volume contradicts an independent one.
[[nodiscard]] std::optional<TopoDS_Shape> solid_in_box(const CellShape& cell, const std::vector<Neighbour>& neighbours,
                                                       std::uint64_t present, DiagnosticSink& sink);

}  // namespace meso::brep
