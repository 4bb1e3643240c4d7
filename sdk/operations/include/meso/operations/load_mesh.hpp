// SPDX-License-Identifier: Apache-2.0
#pragma once
// Triangles of whatever can be drawn: a document (realised), .step .stp (tessellated) or .stl .ply .obj
// .off (as they are).

#include "meso/operations/convert.hpp"

namespace meso::operations {

[[nodiscard]] std::optional<TriangleMesh> load_mesh(const std::filesystem::path& file, MakeOptions options,
                                                    DiagnosticSink& sink);

}  // namespace meso::operations
