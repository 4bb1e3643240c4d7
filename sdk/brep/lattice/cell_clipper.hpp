// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a body leaves of the solid in one cell box: one checked boolean, in the cell's own frame. Private.
//
// The cell's solid is split by the few faces of the body that touch its box, however large the body is. A piece that
// has a face of the body for its own lies in the body if both look the same way. Trusted only if the pieces add up to
// what was split, all their faces say the same, a point within each agrees, and every edge is known to a thousandth of
// the cell; else tried again with a fuzzy tolerance, then with the body shifted by a millionth of the cell.
//
// Thread rule: one for each thread; it works on copies of its own, because OpenCASCADE writes to the shapes it reads.

#include <TopTools_DataMapOfShapeReal.hxx>
#include <deque>
#include <string>
#include <vector>

#include "lattice/body_surface.hpp"
#include "meso/base/run_options.hpp"

namespace meso::brep {

struct ClippedCell {
  enum class Left : std::uint8_t { nothing, all, part };
  Left left = Left::nothing;
  TopoDS_Shape solid;  ///< where a part is left: a compound of solids
  std::string fault;   ///< why there is none
};

class CellClipper {
 public:
  /// `solids` are what the different kinds of box hold whole; null shapes are empty boxes.
  CellClipper(const std::vector<TopoDS_Shape>& solids, const BodySurface& surface, const CellGrid& grid,
              const RunOptions& run);

  /// Box `cell`, of that kind, and the numbers of the faces that touch it.
  [[nodiscard]] ClippedCell clip(std::uint32_t kind, const Index3& cell, const std::vector<std::uint32_t>& faces);

 private:
  struct Attempt {
    double fuzzy = 0;
    Vec3 shift;
  };
  [[nodiscard]] bool in_body(Vec3 p);
  [[nodiscard]] ClippedCell attempt(const Attempt& how, std::uint32_t kind, const Index3& cell,
                                    const std::vector<std::uint32_t>& faces);

  /// Its share of the volume of what it bounds.
  [[nodiscard]] double share_of(const TopoDS_Face& face);
  [[nodiscard]] double volume_of(const TopoDS_Shape& piece);

  std::vector<std::vector<TopoDS_Shape>> solids_;  ///< per kind
  std::vector<double> volumes_;
  TopTools_DataMapOfShapeReal shares_;  ///< of faces of `solids_`, taken forward: most are in many pieces, whole
  TopTools_DataMapOfShapeReal recent_;  ///< of the faces of one attempt: a cap bounds two pieces
  std::vector<TopoDS_Face> faces_;
  std::deque<BRepClass3d_SolidClassifier> body_;  // they cannot be moved
  CellGrid grid_;
  const RunOptions& run_;
};

}  // namespace meso::brep
