// SPDX-License-Identifier: Apache-2.0
#pragma once
// Writes a stream of triangles as STL.
//
//   const StlCounts counts = write_stl(triangles_of(body), StlFormat::binary, file);
//
// Coordinates are rounded to 32-bit floats as STL stores them. A triangle two of whose corners round to the same point
// is left out: its other two half-edges cancel each other, so a closed mesh stays closed. Equal streams give equal
// bytes. Binary visits the stream twice, because the count stands before the triangles. Constant memory; over ten
// million triangles a second. Errors: `complete` is false if the sink failed, or for more than 2^32 - 1 binary
// triangles.

#include <cstdint>

#include "meso/base/byte_sink.hpp"
#include "meso/base/triangle_stream.hpp"
#include "meso/export_stl/stl_facet.hpp"

namespace meso {

struct StlCounts {
  std::uint64_t bytes = 0, triangles = 0;
  std::uint64_t left_out = 0;  ///< triangles that rounding to floats has folded up
  bool complete = true;
};

[[nodiscard]] StlCounts write_stl(const TriangleStream& triangles, StlFormat format, ByteSink& sink);

}  // namespace meso
