// SPDX-License-Identifier: Apache-2.0
#pragma once
// The faces of a closed solid and the faces of a body near it, divided along each other and put together to what the
// solid and the body have in common. Private.
//
// Only faces that come near the body are intersected, all others are inside or outside as a whole: no solid is ever
// built by OpenCASCADE. Faces that hang together without crossing the body's surface are on one side of it, and one
// point says on which. What tells a wrong answer: the pieces of every face have its area and its share of the volume;
// each edge of the result is used once in each direction; the faces of the result, as vectors, add up to nothing;
// corners of whole faces are all on the side of their piece.
//
// Thread rule: one for each thread.

#include <BRepClass3d_SolidClassifier.hxx>
#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "lattice/mesh_probe.hpp"
#include "meso/base/run_options.hpp"
#include "occt.hpp"

namespace meso::brep {

struct ClippedCell {
  enum class Left : std::uint8_t { nothing, all, part };
  Left left = Left::nothing;
  TopoDS_Shape solid;  ///< where a part is left: a compound of solids
  std::string fault;   ///< why there is none
  std::size_t attempts = 1;
};

/// One kind of box: its solids, with what is asked of them again and again.
struct WholeCell {
  struct Face {
    TopoDS_Face face;  ///< outward
    std::vector<Triangle3> triangles;
    Box3 box;
    double share = 0;  ///< of the volume
    Vec3 area;         ///< as a vector
  };
  std::vector<Face> faces;
  MeshProbe probe;
  std::deque<BRepClass3d_SolidClassifier> solids;  // they cannot be moved
  double volume = 0;
  double reach = 0;  ///< how far a face is from its triangles
};
[[nodiscard]] WholeCell whole_cell(const TopoDS_Shape& solid, double deflection);

/// The body near one cell, in the cell's frame.
struct LocalBody {
  std::vector<TopoDS_Shape> faces;  ///< compounds, one for each solid
  std::vector<Triangle3> triangles;
  double reach = 0;                    ///< how far a face is from its triangles
  std::function<bool(Vec3)> contains;  ///< for points that keep `reach` from the triangles
  std::function<int(Vec3)> side;       ///< of any point, slowly; +1: inside, -1: outside, 0: too close to say
};

struct SplitOptions {
  bool all_faces = false;  ///< also those that do not come near
  double fuzzy = 0;
  double size = 0;  ///< of the cell: lengths below 1e-6 of it do not count
};

/// May throw Standard_Failure.
[[nodiscard]] ClippedCell split_cell(WholeCell& cell, const LocalBody& body, const SplitOptions& options,
                                     const RunOptions& run);

}  // namespace meso::brep
