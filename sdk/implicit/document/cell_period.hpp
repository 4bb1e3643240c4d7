// SPDX-License-Identifier: Apache-2.0
#pragma once
// Samples of a lattice of cells that comes again to the nodes of the grid: one period of it is evaluated, and its
// samples are copied wherever all is there that they come from. Private.
//
// A lattice of 5 mm on a grid of 0.2 mm comes again every 25 nodes. Copies are those of the first period to the bit, so
// all cells that are whole have the same triangles; they differ from what would be evaluated by no more than rounding.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "brick_contents.hpp"
#include "placed_cells.hpp"

namespace meso::implicit {

class CellPeriod {
 public:
  /// Empty where the lattice does not come again, where copying would save little, and where the run was stopped.
  [[nodiscard]] static std::unique_ptr<const CellPeriod> find(const PlacedCells& cells, const Grid& grid,
                                                              const Affine& field_from_grid, const Nearness& nearness,
                                                              const RunOptions& run);
  /// What it may hold at most for so many nodes.
  [[nodiscard]] static std::uint64_t most_bytes(std::uint64_t nodes);

  /// Nodes first ... last - 1 of a row; those that are not copied have to be evaluated.
  struct Run {
    std::int32_t first, last;
    bool copied;
  };
  /// Rows of one band along an axis (1 or 2) have the same runs.
  [[nodiscard]] std::int32_t band(std::size_t axis, std::int32_t node) const;
  /// Of the whole row.
  void find_runs(std::int32_t j, std::int32_t k, std::vector<Run>& runs) const;
  /// REQUIRES: within a run that is copied.
  void copy(std::int32_t j, std::int32_t k, std::int32_t first, std::int32_t last, double* out) const;
  /// Nothing if it is not copied.
  [[nodiscard]] std::optional<double> at(std::int32_t i, std::int32_t j, std::int32_t k) const;

 private:
  using Steps = std::array<std::int64_t, 3>;
  /// Along an axis of the grid.
  struct Axis {
    std::int32_t nodes = 0;           ///< of a period
    Steps steps{};                    ///< of the lattice, meanwhile
    std::vector<std::int32_t> part;   ///< by node
    std::vector<std::int32_t> begin;  ///< of each part, and where the last ends
    void divide();
    [[nodiscard]] std::size_t parts() const { return begin.size() - 1; }
  };
  /// A brick of a period, and which copies of the lattice's cell it needs.
  struct Part {
    struct Need {
      std::uint32_t thing;
      Steps copy;  ///< one that places it
    };
    Steps least{0, 0, 0}, most{-1, -1, -1};  ///< of all
    std::uint32_t need = 0, needs = 0;       ///< ordered by thing
  };

  CellPeriod() = default;
  static Axis axis_of(std::size_t axis, const Grid& grid, const Affine& map, const Repetition& repetition);
  void sample_part(const PlacedCells& cells, const Grid& grid, const Affine& map, const Nearness& nearness,
                   std::array<std::size_t, 3> part);
  [[nodiscard]] bool is_whole(const Part& part, const Steps& from) const;
  [[nodiscard]] Steps steps_at(std::int32_t i, std::int32_t j, std::int32_t k) const;
  [[nodiscard]] const Part& part_at(std::int32_t i, std::int32_t j, std::int32_t k) const;
  [[nodiscard]] const double* row(std::int32_t j, std::int32_t k) const;

  std::array<Axis, 3> axes_;
  Steps count_{};
  std::int32_t row_nodes_ = 0;  ///< of the grid
  std::vector<Part> parts_;
  std::vector<Part::Need> needs_;
  std::vector<double> samples_;  ///< of a period
};

}  // namespace meso::implicit
