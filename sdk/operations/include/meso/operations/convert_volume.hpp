// SPDX-License-Identifier: Apache-2.0
#pragma once
// From a document to a volume by the implicit engine: tetrahedra, voxels or slices, by the output's extension.
//
//   convert_to_volume("part.meso", "part.inp", {}, {.elements = 1e6}, sink);
//
// The grid is that of a mesh: spacing or samples that are asked for, else the document's, else a fifth of the smallest
// feature. Of tetrahedra for which none is stated there are about a million. A document that is words (meso sdf -o
// part.meso) makes the very bytes that the words make. Thread rule: as convert().

#include "meso/operations/convert.hpp"
#include "meso/operations/volume_outputs.hpp"

namespace meso::operations {

[[nodiscard]] std::optional<VolumeReport> convert_to_volume(const std::filesystem::path& in, const std::string& out,
                                                            const MakeOptions& options, const VolumeOptions& volume,
                                                            DiagnosticSink& sink);

}  // namespace meso::operations
