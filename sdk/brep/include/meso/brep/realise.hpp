// SPDX-License-Identifier: Apache-2.0
#pragma once
// A part of a document as an exact body.
//
//   DiagnosticSink sink;
//   auto evaluation = eval::Evaluation::make(checked, {}, sink);
//   if (auto made = brep::realise_build(*evaluation, {}, {}, sink)) write_step(made->body, ...);
//
// Four ways lead to a body, the first that fits is taken: a lattice of boxes side by side becomes one repeated
// template, clipped where the macrostructure's boundary crosses it ("lattice"); beams whose struts all end within the
// balls of their nodes are put together from whole balls, cylinders and cones ("beamGraph"); cells that keep clear of
// the macrostructure's boundary and of each other become solids or voids of their own ("cells"); what is left is joined
// by general booleans, each checked ("boolean"): beams that differ as one body, other cells one by one. A part without
// steps is its macrostructure ("direct"). Parts that stand in cells or as operands are made once.
//
// Units: millimetres, radians. Errors: an empty optional and GEOMETRY_*, IMPORT_*, LIMIT_* or BREP_NOT_REALISED in the
// sink; never a wrong body. Cost: lattice, a second and 0.1 ms a cell; cells, about 1 ms each; boolean, 50 ms and more
// for each solid, refused beyond `max_boolean_solids`. Thread rule: may run in several threads on different documents;
// STEP files are read one at a time.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "meso/brep/body.hpp"
#include "meso/eval/evaluation.hpp"

namespace meso::brep {

struct RealiseOptions {
  bool mesh = false;           ///< triangulate, too
  double deflection_mm = 0.1;  ///< largest distance of the triangles from the exact surface
  double angle_rad = 0.5;      ///< largest turn along one segment
  RunOptions run{};
  std::size_t max_boolean_solids = 600;  ///< that booleans may have to unite in one step; cutters: ten times
};

struct CellCounts {
  std::uint64_t placed = 0;    ///< by the generators, before `when`
  std::uint64_t kept = 0;      ///< that take part in the result
  std::uint64_t crossing = 0;  ///< kept, and cut by the macrostructure's boundary
  std::size_t fragments = 0;   ///< solids beyond the largest that a cut has left loose
  std::size_t dropped = 0;     ///< of these, those that the document leaves out
};

/// How the cells of a lattice were cut at the boundary of a body: those that see the same piece of it share a result.
struct ClipCounts {
  std::uint64_t distinct = 0;             ///< results that were made
  std::vector<std::uint64_t> attempts{};  ///< [n]: of these, took n + 1 attempts
  double edge_tolerance = 0;              ///< how far an edge may be from its faces, at most, in millimetres
};

struct Realisation {
  Body body;
  CellCounts cells;
  ClipCounts clip;
  std::string way;  ///< "direct", "lattice", "beamGraph", "cells" or "boolean"; the last that was needed
  double evaluate_seconds = 0, realise_seconds = 0;
};

[[nodiscard]] std::optional<Realisation> realise(const eval::Evaluation& evaluation, const Part& part,
                                                 const RealiseOptions& options, DiagnosticSink& sink);

/// A macrostructure alone, in the world.
[[nodiscard]] std::optional<Body> realise_macrostructure(const eval::Evaluation& evaluation,
                                                         const Macrostructure& macrostructure,
                                                         const RealiseOptions& options, DiagnosticSink& sink);

/// What `build` lists, each item placed; with `part_id` that part alone; without a build the only part.
[[nodiscard]] std::optional<Realisation> realise_build(const eval::Evaluation& evaluation,
                                                       std::optional<std::string_view> part_id,
                                                       const RealiseOptions& options, DiagnosticSink& sink);

}  // namespace meso::brep
