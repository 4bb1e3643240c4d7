// SPDX-License-Identifier: Apache-2.0
#pragma once
// The solids of a STEP, IGES or BREP file as a body, for audits and pictures of files that somebody else has written.
//
//   if (const auto body = read_step("part.stp", {.deflection_mm = 0.1}, run, sink)) measure(*body);
//
// Millimetres, whatever unit the file has; BREP has none, its numbers are taken as they are. The file must hold closed
// solids (IMPORT_NOT_CLOSED); nothing is healed. Triangles only where a deflection is given. Cost: OpenCASCADE's
// reader, about 1 ms a face and growing faster than the number of faces.

#include <filesystem>
#include <optional>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/brep/body.hpp"
#include "meso/resource/resource.hpp"

namespace meso::brep {

struct ReadStepOptions {
  std::optional<double> deflection_mm{};
  std::optional<double> relative_deflection{};  ///< the same as a fraction of the diagonal of the solids' box
  double angle_rad = 0.5;
  bool mesh_may_fail = false;  ///< then a body without triangles will do
  bool may_cross = true;       ///< else a surface that passes through itself is IMPORT_OVERLAPS
};

/// By its extension: .step .stp .iges .igs .brep, in any case.
[[nodiscard]] bool is_exact_file(const std::filesystem::path& file);

[[nodiscard]] std::optional<Body> read_step(const Resource& file, const ReadStepOptions& options, const RunOptions& run,
                                            DiagnosticSink& sink);

}  // namespace meso::brep
