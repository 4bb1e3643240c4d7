// SPDX-License-Identifier: Apache-2.0
#pragma once
// Reads an STL file, binary or ASCII, strictly.
//
//   std::optional<TriangleMesh> mesh = read_stl(bytes, "bunny.stl", sink);
//
// A file is binary if its size is what its triangle count announces, or if it does not begin with "solid". Corners with
// equal coordinates become one point; nothing else is merged, repaired or dropped, and stored normals are not used.
// Coordinates are taken as they are (STL has no unit). Several ASCII solids become one mesh. Errors: STL_TRUNCATED,
// STL_EXTRA_BYTES, STL_SYNTAX, STL_NOT_FINITE, STL_EMPTY. About five million binary triangles a second. Thread rule:
// pure.

#include <optional>
#include <string>
#include <string_view>

#include "meso/base/diagnostic.hpp"
#include "meso/base/triangle_mesh.hpp"

namespace meso {

[[nodiscard]] std::optional<TriangleMesh> read_stl(std::string_view bytes, const std::string& file,
                                                   DiagnosticSink& sink);

}  // namespace meso
