// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a body leaves of the solid in one cell box, or adds to it: one checked boolean, in the cell's own frame.
// Private.
//
// A result that does not pass the checks of cell_split, or whose edges are known to less than a thousandth of the cell,
// is made again in other ways: with the whole faces of body and cell, with other parameters of the cell's faces, with a
// fuzzy tolerance, with the body shifted by a millionth of the cell. How many ways were tried is told; of results with
// rough edges the best is taken.
//
// Thread rule: one for each thread; it works on copies of its own, because OpenCASCADE writes to the shapes it reads.

#include <deque>
#include <functional>
#include <map>
#include <vector>

#include "lattice/body_surface.hpp"
#include "lattice/cell_split.hpp"
#include "lattice/local_faces.hpp"
#include "meso/base/run_options.hpp"

namespace meso::brep {

/// Of the cell: edges that are known to less are told.
constexpr double rough_edge = 1e-3;

class CellClipper {
 public:
  using Otherwise = std::function<TopoDS_Shape(std::uint32_t kind, int variant)>;

  /// `solids` are what the different kinds of box hold whole; null shapes are empty boxes.
  /// `otherwise`: the same solid with other parameters of its faces, for variants 1 and on; null shapes, or none,
  /// where there is no such way.
  CellClipper(const std::vector<TopoDS_Shape>& solids, const Otherwise& otherwise, const BodySurface& surface,
              const CellGrid& grid, const RunOptions& run);
  /// The union of box and body, by the frames of the kinds (box_frame); `frame` is asked once for each;
  /// frames have no variants.
  CellClipper(std::function<WholeCell(std::uint32_t, int)> frame, const BodySurface& surface, const CellGrid& grid,
              const RunOptions& run);

  /// Of the ways to make a cell: those before anything is moved or looked at again, or all.
  enum class Ways : std::uint8_t { first, all };
  /// Box `cell`, of that kind, and the numbers of the faces that touch it.
  [[nodiscard]] ClippedCell clip(std::uint32_t kind, const Index3& cell, const std::vector<std::uint32_t>& faces,
                                 Ways ways = Ways::all);

 private:
  struct Attempt {
    bool patches = true, all_faces = false;
    double fuzzy = 0;
    Vec3 shift;
    int variant = 0;
  };
  [[nodiscard]] WholeCell& whole(std::uint32_t kind, int variant);
  [[nodiscard]] ClippedCell attempt(const Attempt& how, WholeCell& whole, const Index3& cell,
                                    const std::vector<std::uint32_t>& faces);
  [[nodiscard]] int side_of(Vec3 p);

  std::function<WholeCell(std::uint32_t, int)> make_;
  std::map<std::pair<std::uint32_t, int>, WholeCell> whole_;  ///< those that were asked for
  const BodySurface& surface_;
  LocalFaces local_;
  std::deque<BRepClass3d_SolidClassifier> body_;  // they cannot be moved
  CellGrid grid_;
  const RunOptions& run_;
};

}  // namespace meso::brep
