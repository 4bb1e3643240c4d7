// SPDX-License-Identifier: Apache-2.0
#pragma once
// All cells of a pattern: each different body once, placed often, found by a tree of boxes. Private.

#include <memory>

#include "solid.hpp"

namespace meso::membership {

class CellSet {
 public:
  /// Empty with a diagnostic if evaluation fails, a limit is reached or the run is stopped.
  [[nodiscard]] static std::optional<CellSet> make(const eval::CellStream& cells, const Surroundings& surroundings,
                                                   const RunOptions& run, DiagnosticSink& sink);

  /// In the union of the cells that are taken.
  [[nodiscard]] Answer at(Vec3 p) const;
  [[nodiscard]] Box3 box() const { return tree_->box(); }

  /// Keeps the cells that are inside `body` by `clearance`, or that meet it.
  struct Rule {
    enum class Kind { inside, meeting } kind = Kind::inside;
    InsideTest judged = InsideTest::box;
    double clearance = 0;
  };
  void take(const Rule& rule, const Solid& body);

 private:
  struct Cell {
    std::uint32_t solid = 0;   ///< of solids_
    std::uint32_t region = 0;  ///< of regions_
    Affine placement, back;    ///< world_from_cell, cell_from_world; identity for conformal cells
    Answer taken = Answer::inside;
  };
  class Collector;

  std::vector<Solid> solids_;
  std::vector<std::optional<eval::Shape>> regions_;  ///< in the frame of the solid
  std::vector<Cell> cells_;
  std::shared_ptr<const BoxTree> tree_;
};

}  // namespace meso::membership
