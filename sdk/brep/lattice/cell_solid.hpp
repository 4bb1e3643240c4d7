// SPDX-License-Identifier: Apache-2.0
#pragma once
// What the solid is inside one cell box: the primitives of the cell and of the neighbours that reach in, fused and cut
// to the box. Private.

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/brep/lattice_body.hpp"
#include "occt.hpp"

namespace meso::brep {

class VariedCells;

/// A unit cell as OpenCASCADE solids. `primitives` is parallel to `solids`, or empty where the solids are not beams.
struct CellShape {
  Box3 box;
  std::vector<TopoDS_Shape> solids;
  std::vector<CellPrimitive> primitives;
  bool cut_to_box = false;                      ///< what sticks out is not there: nothing reaches into a neighbour
  std::shared_ptr<const VariedCells> varied{};  ///< which primitives each cell has; null: all have all

  [[nodiscard]] Vec3 size() const { return box.max - box.min; }
  /// Two points closer than this are one.
  [[nodiscard]] double tolerance() const { return 1e-6 * std::fmax(size().x, std::fmax(size().y, size().z)); }
};

[[nodiscard]] std::optional<CellShape> cell_shape(const LatticeCell& cell, DiagnosticSink& sink);

/// The same set of points with the poles of balls hidden or left out, if that can be done for any. What a body cuts
/// into balls is found more surely; pieces of one ball are not joined, and files are larger. Not of cells that vary.
[[nodiscard]] std::optional<CellShape> with_poles_aside(const CellShape& cell);

/// Which solids of which cells shape the inside of one box.
struct Reach {
  struct Part {
    std::size_t solid = 0;  ///< of cell + shift
    Index3 shift{};
  };
  struct Neighbour {
    Index3 shift{};
    std::vector<std::uint32_t> parts;  ///< what it adds to the cell's own
  };
  std::vector<Part> parts;  ///< no two alike
  std::vector<std::uint32_t> own;
  std::vector<Neighbour> neighbours;  ///< only those that add something
  std::vector<Neighbour> rim;         ///< what all of them add where the cell itself does not exist

  /// Of a cell of the pattern, or of one beyond it; bit n of `present`: neighbour n of the one list or the other
  /// exists. Sorted.
  [[nodiscard]] std::vector<std::uint32_t> parts_with(bool itself, std::uint64_t present) const;
};
[[nodiscard]] Reach reach_of(const CellShape& cell);

/// How many kinds of box may yet be made by booleans, whichever thread asks.
class FusedBudget {
 public:
  explicit FusedBudget(std::size_t most) : left_(static_cast<std::int64_t>(most)) {}
  [[nodiscard]] bool take() { return --left_ >= 0; }
  [[nodiscard]] bool is_exceeded() const { return left_ < 0; }

 private:
  std::atomic<std::int64_t> left_;
};

/// The given parts, fused and cut to the box; null if there is nothing. Empty, with a diagnostic, if a boolean fails or
/// its volume contradicts an independent one, or the run is to stop; without one, if cells vary and the budget is
/// spent.
[[nodiscard]] std::optional<TopoDS_Shape> solid_in_box(const CellShape& cell, const Reach& reach,
                                                       const std::vector<std::uint32_t>& parts, const RunOptions& run,
                                                       DiagnosticSink& sink, FusedBudget* budget = nullptr);

/// Takes no boolean: some 50 times faster.
[[nodiscard]] bool is_put_together(const CellShape& cell, const Reach& reach, const std::vector<std::uint32_t>& parts);

/// The same points between faces with other parameters, 1 and on; null where there is no such way. Only of cells that
/// vary.
[[nodiscard]] TopoDS_Shape solid_in_box_otherwise(const CellShape& cell, const Reach& reach,
                                                  const std::vector<std::uint32_t>& parts, int variant);

}  // namespace meso::brep
