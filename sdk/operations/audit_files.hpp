// SPDX-License-Identifier: Apache-2.0
#pragma once
// Audits of geometry files that somebody else may have written.

#include "meso/operations/verify.hpp"

namespace meso::operations {

/// Of triangles. Closed, oriented, no facet folded, no contact of the surface with itself, positive volume.
[[nodiscard]] std::optional<VerifyReport> audit_mesh_file(const std::filesystem::path& file, const RunOptions& run,
                                                          DiagnosticSink& sink);
/// The same questions to the exact boundary representation, as OpenCASCADE reads it. Of more than 10 000 faces only the
/// topology, from the text alone, unless `deep`.
[[nodiscard]] std::optional<VerifyReport> audit_step(const std::filesystem::path& file, bool deep,
                                                     const RunOptions& run, DiagnosticSink& sink);

}  // namespace meso::operations
