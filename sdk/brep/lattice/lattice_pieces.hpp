// SPDX-License-Identifier: Apache-2.0
#pragma once
// The connected solids that the boxes of a lattice make together, before their faces are put together. Private.
//
// They are what fragments are counted by, where a body is added after a cut. Solids of two boxes are one where their
// walls share area. Cost: a microsecond a box, and some booleans of plane faces where walls are divided differently.

#include "lattice/assembly.hpp"
#include "lattice/cell_grid.hpp"

namespace meso::brep {

class LatticePieces {
 public:
  /// May throw Standard_Failure.
  LatticePieces(const CellGrid& grid, const KeptCells& cells, const CellKinds& kinds,
                const std::vector<TopoDS_Shape>& solids);

  /// A point in each; nothing where a piece is too thin to say.
  [[nodiscard]] const std::vector<std::optional<Vec3>>& points() const { return points_; }
  /// Which of them a point is in, if any. May throw Standard_Failure.
  [[nodiscard]] std::optional<std::size_t> at(Vec3 p) const;

 private:
  [[nodiscard]] std::uint32_t lump(std::uint32_t cell, std::size_t number) const {
    return first_lump_[cell] + static_cast<std::uint32_t>(number);
  }

  CellGrid grid_;
  std::map<Index3, std::uint32_t> numbers_;  ///< of the cells
  std::vector<std::uint32_t> kind_of_;
  std::vector<std::vector<TopoDS_Shape>> lumps_;  ///< by kind
  std::vector<std::uint32_t> first_lump_;         ///< by cell
  std::vector<std::size_t> piece_of_;             ///< by lump
  std::vector<std::optional<Vec3>> points_;
};

}  // namespace meso::brep
