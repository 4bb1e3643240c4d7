// SPDX-License-Identifier: Apache-2.0
#pragma once
// Lattices whose struts differ from cell to cell. The CellShape then has the primitives of all cells, each once, and
// this tells which of them a cell has, and from there which of them shape the inside of a box. Private.

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "lattice/cell_solid.hpp"

namespace meso::brep {

/// The cells (0, 0, 0) ... `last`: indices of primitives of the shape.
class VariedCells {
 public:
  explicit VariedCells(const Index3& last) : last_(last), cells_(slot(last) + 1) {}
  /// Any number of cells, all alike.
  explicit VariedCells(std::vector<std::uint32_t> of_each) : are_alike_(true), cells_{std::move(of_each)} {}

  void set(const Index3& cell, std::vector<std::uint32_t> primitives) { cells_[slot(cell)] = std::move(primitives); }
  [[nodiscard]] const std::vector<std::uint32_t>& of(const Index3& cell) const { return cells_[slot(cell)]; }

 private:
  [[nodiscard]] std::size_t slot(const Index3& cell) const {
    if (are_alike_) return 0;
    const auto at = [&](std::size_t i) { return static_cast<std::size_t>(cell[i]); };
    const auto extent = [&](std::size_t i) { return static_cast<std::size_t>(last_[i]) + 1; };
    return (at(0) * extent(1) + at(1)) * extent(2) + at(2);
  }

  Index3 last_{};
  bool are_alike_ = false;
  std::vector<std::vector<std::uint32_t>> cells_;
};

/// Primitives, each once: those that differ by less than a billionth of the box are one.
class PrimitiveTable {
 public:
  explicit PrimitiveTable(double size) : quantum_(1e-9 * size) {}

  [[nodiscard]] std::uint32_t number_of(const CellPrimitive& primitive);
  [[nodiscard]] const std::vector<CellPrimitive>& all() const { return all_; }

 private:
  double quantum_;
  std::vector<CellPrimitive> all_;
  std::map<std::array<std::int64_t, 8>, std::uint32_t> numbers_;
};

/// The parts of boxes, for cell_kinds and solid_in_box.
class VariedBoxes {
 public:
  /// REQUIRES: cell.varied. The shape must outlive this.
  explicit VariedBoxes(const CellShape& cell);

  /// Its parts: those of boxes that were asked for. Of neighbours there are only the shifts from which anything
  /// reaches.
  [[nodiscard]] const Reach& reach() const { return reach_; }
  /// What is in a box if the pattern has just the cells it is asked about. Sorted.
  [[nodiscard]] std::vector<std::uint32_t> parts_of(const Index3& box, const std::function<bool(Index3)>& in_pattern);

 private:
  [[nodiscard]] bool reaches(std::uint32_t solid, const Index3& shift) const;

  const CellShape& cell_;
  std::vector<Box3> bounds_;
  Reach reach_;
  PrimitiveTable placed_;  ///< parallel to the parts
};

/// A cell that all boxes have, as if they varied, so that boxes are put together without a boolean, and in several
/// ways. Nothing where one in the midst of others takes a boolean all the same.
[[nodiscard]] std::optional<CellShape> as_varied(const CellShape& cell);

}  // namespace meso::brep
