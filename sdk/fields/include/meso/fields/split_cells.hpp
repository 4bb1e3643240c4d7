// SPDX-License-Identifier: Apache-2.0
#pragma once
// Cells with more than four corners as tetrahedra.
//
//   std::vector<std::int64_t> tetra;
//   append_tetrahedra(CellKind::wedge, std::array<std::int64_t, 6>{0, 1, 2, 3, 4, 5}, tetra);   // three: 12 numbers
//
// All meet at the corner with the lowest number, and a side of four corners is halved from its own lowest one
// (Dompierre et al. 1999), so that neighbours agree on the side that they share, whatever they are. Corners are in
// VTK's order, which is that of Gmsh and CalculiX. Stateless.

#include <cstdint>
#include <span>
#include <vector>

namespace meso::fields {

enum class CellKind { pyramid, wedge, hexahedron };

[[nodiscard]] std::size_t corners_of(CellKind kind);  ///< 5, 6, 8

/// REQUIRES: corners.size() == corners_of(kind).
void append_tetrahedra(CellKind kind, std::span<const std::int64_t> corners, std::vector<std::int64_t>& tetra);

}  // namespace meso::fields
