// SPDX-License-Identifier: Apache-2.0
#pragma once
// lattice_body for bodies whose boundary runs through the cells: one that the lattice is cut to, one that is added.
// Private.
//
// Cells that see the same piece of a body are clipped, or united with it, once, in parallel; the results are further
// kinds of box, and everything after that is as for whole boxes.

#include "lattice/cell_clipper.hpp"
#include "lattice/lattice_pieces.hpp"
#include "lattice/shape_lattice.hpp"
#include "meso/base/run_options.hpp"
#include "meso/brep/realise.hpp"

namespace meso::brep {

struct ClippedLattice {
  Body body;
  std::uint64_t kept = 0;                            ///< cells of which something is left
  std::uint64_t crossing = 0;                        ///< of these, cut by the boundary
  ClipCounts clip;                                   ///< booleans they took
  bool is_given_up = false;                          ///< there is nothing: the first ways were not enough
  std::shared_ptr<const LatticePieces> cut, joined;  ///< before and after bodies are added, where they are asked for
};

enum class PiecesAsked : std::uint8_t { none, of_cut, of_both, of_both_and_no_body };

/// Kinds of cells that vary which may take a boolean each, half a second to a second.
struct FusedLimit {
  std::size_t most = 1'000;
  bool is_told = true;  ///< LIMIT_BOOLEANS; else, where there is another way, nothing
};

struct ClipOptions {
  std::optional<MeshFineness> mesh{};
  bool reuse = true;      ///< one boolean for all cells that see the same piece of the body
  Index3 block{1, 1, 1};  ///< boxes of one cell along each axis, where a cell has several: these count as one
  PiecesAsked pieces = PiecesAsked::none;
  std::vector<TopoDS_Shape> added{};  ///< solids that are united with what is left, as `body` is given
  FusedLimit fused{};
  CellClipper::Ways ways = CellClipper::Ways::all;  ///< to cut a cell by `body`
};

/// Body n regularised union of the cells (0, 0, 0) ... `last`. `body`: outward solids in the frame of the cell whose
/// interiors do not meet; without any, cells are not cut. Empty, with a diagnostic, if something fails or the run is to
/// stop.
[[nodiscard]] std::optional<ClippedLattice> clipped_lattice_body(const CellShape& cell, const Index3& last,
                                                                 const std::vector<TopoDS_Shape>& body,
                                                                 const ClipOptions& options, const RunOptions& run,
                                                                 DiagnosticSink& sink);

}  // namespace meso::brep
