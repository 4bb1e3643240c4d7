// SPDX-License-Identifier: Apache-2.0
#pragma once
// A lattice modulo its translations: the faces of one cell (of each kind of cell), its edges and vertices, and which
// faces meet at each edge in whatever cells they stand. Private.

#include <memory>
#include <set>
#include <vector>

#include "lattice/cell_solid.hpp"
#include "lattice/enclosed.hpp"
#include "lattice/union_find.hpp"
#include "meso/brep/body.hpp"

namespace meso::brep {

/// A face of the solid in one box. Skin is always there. A wall lies on the box plane `axis`, `side` (0 low, 1 high)
/// and is there unless the cell across has the same wall orbit on its other side.
struct CellFace {
  std::uint32_t face = 0;  ///< in the template
  int axis = -1;           ///< -1: skin
  int side = 0;
  std::uint32_t wall_orbit = 0;
  std::uint32_t cluster = 0;  ///< faces of one cluster are on one shell whatever the neighbours are
};

struct EdgeUse {
  std::uint32_t kind = 0, face = 0;  ///< face: index into CellKind::faces
  Index3 face_cell{};                ///< relative to the edge's cell
  bool reversed = false;
};

/// What one box holds, by which solids reach into it.
struct CellKind {
  std::vector<CellFace> faces;
  std::vector<TopoDS_Face> shapes;           ///< parallel to faces
  std::vector<std::uint32_t> cluster_lumps;  ///< the connected solid each cluster bounds
  std::uint32_t lumps = 0;
  std::set<std::uint64_t> walls;  ///< 2 * wall_orbit + side
  double volume = 0;
  struct EdgeAt {
    std::uint32_t edge = 0;
    Index3 offset{};
  };
  std::vector<EdgeAt> boundary_edges;  ///< on the box planes
};

/// A face that box walls cut into pieces, made whole. `parts[0]` is in the cell that owns it.
struct NaturalFace {
  std::uint32_t face = 0;
  struct Part {
    Index3 offset{};
    std::uint32_t piece = 0;  ///< index into the faces of kind 0
  };
  std::vector<Part> parts;
};

struct Quotient {
  std::shared_ptr<Template> geometry = std::make_shared<Template>();
  std::vector<CellKind> kinds;             ///< kind 0: every solid that can reach in does
  std::vector<std::vector<EdgeUse>> uses;  ///< per edge of the template
  std::vector<std::vector<Vec3>> samples;  ///< per edge: points along it, ends left out
  std::vector<NaturalFace> naturals;
  struct PartOf {
    std::int32_t natural = -1;  ///< none
    Index3 offset{};            ///< the piece's cell is (owner's cell) + offset
    bool owner = false;
  };
  std::vector<PartOf> part_of;  ///< per face of kind 0
  double tolerance = 0;
};

/// Whether uncancelled walls of `low` (its high side) and `high` (its low side) share area: then the template does not
/// describe the lattice, because the union would have no surface there.
[[nodiscard]] bool walls_overlap(const CellKind& low, const CellKind& high, int axis, Vec3 size);

}  // namespace meso::brep
