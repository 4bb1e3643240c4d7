// SPDX-License-Identifier: Apache-2.0
#pragma once
// A solid filled with tetrahedra whose dihedral angles are bounded: isosurface stuffing.
//
//   const BccLattice lattice = bcc_lattice(box, 0.1);
//   const auto corners = compile(term, lattice.corners), centres = compile(term, lattice.centres);
//   const std::optional<TetMesh> mesh = stuff(lattice, *corners, *centres, run, sink);
//   tet_quality(*mesh).min_dihedral;    // at least min_dihedral_bound, whatever the solid
//
// F. Labelle and J. R. Shewchuk, Isosurface Stuffing: Fast Tetrahedral Meshes with Good Dihedral Angles, SIGGRAPH 2007.
// Uniform elements on a body-centred cubic lattice of spacing h, 12 to a cube of h^3. Points of the lattice that the
// surface passes closely move onto it; it cuts the other edges; what is left is one of few stencils. Points of the
// boundary lie on the surface to 1e-6 h, and exactly in the box's planes where the solid reaches them. Where the
// surface meets these, points are moved onto the rim as far as angles stay within 14 and 160 degrees; a few stay
// inside. Other edges of the solid are cut off by up to h, and what is thinner than h may be lost.
//
// Equal meshes for any number of threads. Memory: about 30 bytes for each point of the lattice, 100 for each
// tetrahedron. Errors: LIMIT_GRID_MEMORY, LIMIT_TIME, CANCELLED. A mesh without tetrahedra is a result.

#include <array>
#include <cstdint>
#include <optional>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/base/tet_mesh.hpp"
#include "meso/implicit/grid_source.hpp"

namespace meso::implicit {

/// Two cubic lattices, each with its points in the middle of the other's cells.
struct BccLattice {
  Box3 box;
  double spacing = 0;
  std::array<std::int32_t, 3> cells{};  ///< at least 2
  std::array<bool, 3> aligned{};        ///< the lattice ends at the box's maximum; it always begins at its minimum
  Grid corners, centres;                ///< where the solid is sampled
};

/// About `spacing` apart: up to 3 % less or more where all sides of the box then are whole numbers of cells, which
/// keeps its edges sharp. REQUIRES: a box of positive size, a positive spacing.
[[nodiscard]] BccLattice bcc_lattice(const Box3& box, double spacing);

/// Radians: 10.7 and 164.8 degrees, proven in the paper for the choice of how close is close that is made here.
inline constexpr double min_dihedral_bound = 0.18675, max_dihedral_bound = 2.87630;

/// REQUIRES: sources on the lattice's two grids.
[[nodiscard]] std::optional<TetMesh> stuff(const BccLattice& lattice, const GridSource& corners,
                                           const GridSource& centres, const RunOptions& run, DiagnosticSink& sink);

struct TetQuality {
  double volume = 0;
  double min_dihedral = 0, max_dihedral = 0;  ///< radians; 0 without tetrahedra
};
[[nodiscard]] TetQuality tet_quality(const TetMesh& mesh);

}  // namespace meso::implicit
