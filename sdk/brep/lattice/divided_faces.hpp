// SPDX-License-Identifier: Apache-2.0
#pragma once
// The faces of a cell and those of a body near it, divided along each other. Private.
//
// Only faces that come near the body are given to OpenCASCADE, which builds no solid. The edges along which the two cut
// each other are fitted to both surfaces again (section_curves). Thread rule: one for each thread.

#include <BOPAlgo_Builder.hxx>
#include <IntTools_Context.hxx>
#include <functional>
#include <optional>

#include "lattice/whole_cell.hpp"
#include "meso/base/run_options.hpp"

namespace meso::brep {

/// The body near one cell, in the cell's frame.
struct LocalBody {
  std::vector<TopoDS_Shape> faces;  ///< compounds, one for each solid
  std::vector<Triangle3> triangles;
  std::vector<std::array<std::size_t, 2>> of_face;  ///< per face: its first triangle, and the first of others
  double reach = 0;                                 ///< how far a face is from its triangles
  std::function<bool(Vec3)> contains;               ///< for points that keep `reach` from the triangles
  std::function<int(Vec3)> side;  ///< of any point, slowly; +1: inside, -1: outside, 0: too close to say
};

struct SplitOptions {
  bool all_faces = false;  ///< also those that do not come near
  double fuzzy = 0;
  double size = 0;  ///< of the cell: lengths below 1e-6 of it do not count
};

/// A face of the cell or of the body, or a piece of one.
struct Piece {
  TopoDS_Face face;  ///< outward
  std::uint32_t of = 0;
  bool whole = false;  ///< not divided
  int coincident = 0;  ///< of the cell: a face of the body is the same; +1: and looks the same way
};

struct PieceUse {
  std::uint32_t piece = 0;
  bool reversed = false;
};

struct DividedFaces {
  std::vector<Piece> pieces;  ///< those of the cell first
  std::size_t of_cell = 0;    ///< pieces of the cell
  TopTools_IndexedMapOfShape edges;
  std::vector<std::vector<PieceUse>> uses;  ///< per edge
  std::vector<bool> by_cell, by_body;       ///< per edge: bounds pieces of these
  bool loose = false;                       ///< an edge lies in a face and does not divide it
  Handle(IntTools_Context) context = new IntTools_Context;
};

/// What a boolean has made of a face, looking the same way. Of pieces that two faces share, both name the same one.
[[nodiscard]] std::vector<TopoDS_Face> pieces_of(BOPAlgo_Builder& builder, const TopoDS_Face& face,
                                                 const Handle(IntTools_Context) & context);

/// Empty if they cannot be divided. May throw Standard_Failure.
[[nodiscard]] std::optional<DividedFaces> divide_faces(const WholeCell& cell, const LocalBody& body,
                                                       const SplitOptions& options, const RunOptions& run);

}  // namespace meso::brep
