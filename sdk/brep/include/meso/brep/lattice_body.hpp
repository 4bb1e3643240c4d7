// SPDX-License-Identifier: Apache-2.0
#pragma once
// The body of a lattice whose cell boxes are each wholly inside or wholly outside the macrostructure.
//
//   LatticeCell bcc{.box = {{0, 0, 0}, {5, 5, 5}}, .primitives = {Ball{{0, 0, 0}, 0.9}, Frustum{...}, ...}};
//   LatticeSet set{.min = {0, 0, 0}, .max = {9, 11, 39}, .inside = [&](Index3 cell) { return kept(cell); }};
//   if (auto body = lattice_body(bcc, set, {}, sink)) ...
//
// The result is (union of the inside boxes) n (regularised union of all cells of the pattern): a cell outside the set
// still sends its primitives over the wall when its index is in the pattern's range. Where an inside box meets one that
// is not inside, the solid ends in a flat wall on the box plane.
//
// Units: millimetres. Bodies closer than 1e-6 of the cell's largest edge are taken to touch.
// Errors: an empty optional and GEOMETRY_* in the sink: the caller takes the general path.
// Cost: one boolean per distinct neighbourhood (one for almost every lattice, about 0.5 s for a body-centred cell),
// then a few microseconds and at most some ten bytes per cell. Thread rule: no shared state.

#include <cstdint>
#include <functional>
#include <optional>
#include <variant>
#include <vector>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/base/vec.hpp"
#include "meso/brep/body.hpp"

namespace meso::brep {

struct Ball {
  Vec3 centre;
  double radius = 0;
};

/// A cylinder, or a cone where the radii differ, with flat ends. Spherical caps are balls of their own.
struct Frustum {
  Vec3 start, end;
  double start_radius = 0, end_radius = 0;
};

using CellPrimitive = std::variant<Ball, Frustum>;

struct LatticeCell {
  Box3 box;  ///< one period: cell (i, j, k) is moved by i, j, k box edges
  std::vector<CellPrimitive> primitives;
};

/// `min` and `max` (inclusive) bound the indices of the pattern; `inside` says which of its boxes lie in the body.
struct LatticeSet {
  Index3 min{}, max{};
  std::function<bool(Index3)> inside;
};

/// How fine the templates carry a triangulation; none without it.
struct MeshFineness {
  double deflection = 0;  ///< largest distance from the exact surface, millimetres
  double angle = 0.5;     ///< largest turn along one segment, radians
};

struct LatticeOptions {
  std::optional<MeshFineness> mesh{};
  RunOptions run{};
};

[[nodiscard]] std::optional<Body> lattice_body(const LatticeCell& cell, const LatticeSet& set,
                                               const LatticeOptions& options, DiagnosticSink& sink);

}  // namespace meso::brep
