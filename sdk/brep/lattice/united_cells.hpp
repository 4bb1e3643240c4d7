// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a body adds to the boxes of a lattice. Private.
//
// Boxes wholly in the body are full, boxes that its boundary crosses are united with it (cell_clipper), the others stay
// as they are; what comes out are further kinds of box. Where a box shares a side with one that holds something else
// there, its side is divided along what that one holds, so that both have the same walls.

#include <map>
#include <string>

#include "lattice/assembly.hpp"
#include "lattice/box_frame.hpp"
#include "lattice/cell_clipper.hpp"

namespace meso::brep {

class UnionPlan {
 public:
  /// `surface` is of the body, over all boxes. With `reuse`, boxes that see the same have one result. May throw
  /// Standard_Failure.
  UnionPlan(const BodySurface& surface, const CellGrid& grid, const KeptCells& cells, const CellKinds& kinds,
            const std::vector<TopoDS_Shape>& solids, bool reuse);

  /// How many different boxes there are.
  [[nodiscard]] std::size_t distinct() const { return tasks_.size(); }
  /// Makes them all, as further kinds; adds what each took to `results`. Empty, or why one of them failed; after a stop
  /// nothing has changed.
  [[nodiscard]] std::string run(CellKinds& kinds, std::vector<TopoDS_Shape>& solids, std::vector<ClippedCell>& results,
                                const RunOptions& run);

 private:
  static constexpr std::uint32_t none = KeptCells::none;
  /// Which kinds a box and its neighbours have: `none` where there is nothing, or nothing that divides a side.
  struct FrameKey {
    std::uint32_t own = none;
    std::array<std::uint32_t, 6> beside{none, none, none, none, none, none};
    auto operator<=>(const FrameKey&) const = default;
  };
  struct Task {
    std::uint32_t frame = 0;
    Index3 cell{};
    bool is_full = false;
    ClippedCell result{};
  };

  [[nodiscard]] std::uint32_t kind_at(const Index3& cell) const;
  [[nodiscard]] const BoxWalls& walls(std::uint32_t kind);
  [[nodiscard]] Vec3 shift_to(std::size_t side) const;
  [[nodiscard]] FrameKey frame_of(const Index3& cell);
  [[nodiscard]] std::vector<TopoDS_Shape> outlines_of(const FrameKey& key) const;
  void make_all(const RunOptions& run);

  const BodySurface& surface_;
  CellGrid grid_;
  const KeptCells& cells_;
  const CellKinds& kinds_;
  const std::vector<TopoDS_Shape>& solids_;
  std::map<std::uint32_t, BoxWalls> walls_;
  std::vector<FrameKey> frames_;
  std::vector<Task> tasks_;
  std::vector<std::uint32_t> task_of_;  ///< by the numbers of the cells; `none`: the body is not there
};

/// Divides edges on the sides of boxes wherever a box beside has a vertex there: surfaces' seams, and lines in which a
/// body touches a side, show in one and not in the other, and of four boxes at an edge two share no side. The first
/// kinds, as many as `alike`, are divided alike among themselves. What is divided becomes further kinds. False if that
/// fails. May throw Standard_Failure.
[[nodiscard]] bool align_edges(const CellGrid& grid, const KeptCells& cells, std::uint32_t alike, CellKinds& kinds,
                               std::vector<TopoDS_Shape>& solids);

}  // namespace meso::brep
