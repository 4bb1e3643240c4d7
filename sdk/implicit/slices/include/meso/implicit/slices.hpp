// SPDX-License-Identifier: Apache-2.0
#pragma once
// Cross-sections of a solid as closed polylines.
//
//   const Grid grid{.box = {{-1, -1, 0.05}, {1, 1, 0.95}}, .nodes = {200, 200, 10}};   // ten slices
//   slice(*compile(term, grid), 10, [&](const Slice& s) { return write(s); }, run, diagnostics);
//
// One slice for each plane of the grid, ascending, one at a time. Contours are those of marching squares: vertices
// stand on edges of the grid, where the linear interpolant of two samples is zero. They are closed, along the box's
// border where the solid reaches it; the solid is on their left, so that outer ones go counter-clockwise and filling by
// the even-odd or by the nonzero rule gives the section. Millimetres.
//
// Equal slices for any number of threads. Memory: some planes of samples. Errors: LIMIT_GRID_MEMORY, LIMIT_TIME,
// CANCELLED; false without a diagnostic: `take` said so.

#include <array>
#include <functional>
#include <vector>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/base/slice.hpp"
#include "meso/implicit/grid_source.hpp"

namespace meso::implicit {

/// The first `count` planes of the grid.
[[nodiscard]] bool slice(const GridSource& source, std::int32_t count, const std::function<bool(const Slice&)>& take,
                         const RunOptions& run, DiagnosticSink& diagnostics);

}  // namespace meso::implicit
