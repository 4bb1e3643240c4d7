// SPDX-License-Identifier: Apache-2.0
#pragma once
// Writes triangles as STL.
//
//   const StlCounts counts = write_stl(triangles_of(mesh), StlFormat::binary, file);
//   const StlCounts counts = write_stl(triangle_ranges(body), StlFormat::binary, file, run.jobs);
//
// Coordinates are rounded to 32-bit floats as STL stores them. A triangle two of whose corners round to the same point
// is left out: its other two half-edges cancel each other, so a closed mesh stays closed. Equal triangles give equal
// bytes, whatever `jobs` is. Binary visits them twice, because the count stands before the triangles. Memory is one
// range a thread; over ten million triangles a second and thread. Errors: `complete` is false if the sink failed, or
// for more than 2^32 - 1 binary triangles.

#include <cstdint>

#include "meso/base/byte_sink.hpp"
#include "meso/base/triangle_ranges.hpp"
#include "meso/export_stl/stl_facet.hpp"

namespace meso {

struct StlCounts {
  std::uint64_t bytes = 0, triangles = 0;
  std::uint64_t left_out = 0;  ///< triangles that rounding to floats has folded up
  bool complete = true;
};

[[nodiscard]] StlCounts write_stl(const TriangleStream& triangles, StlFormat format, ByteSink& sink);
/// On `jobs` threads; 0: one for each core. The sink is called by one at a time.
[[nodiscard]] StlCounts write_stl(const TriangleRanges& ranges, StlFormat format, ByteSink& sink, unsigned jobs);

}  // namespace meso
