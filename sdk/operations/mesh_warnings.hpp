// SPDX-License-Identifier: Apache-2.0
#pragma once
// What is told of meshes from samples, whatever they are of. Private.

#include <string>

#include "meso/base/diagnostic.hpp"
#include "meso/base/triangle_mesh.hpp"
#include "meso/operations/mesh_measures.hpp"
#include "meso/sdf/program.hpp"

namespace meso::operations {

/// A positive number for people: so many digits, the rest cut off.
[[nodiscard]] std::string significant(double value, int digits);

/// Twice the volume over the area; 0 of nothing.
[[nodiscard]] double thickness_of(const TriangleMesh& mesh);

/// What a thickness was seen with: "samples" or "elements".
struct Seen {
  double count = 0, spacing_mm = 0;
  const char* called = "samples";
};
/// Walls and struts thinner than the spacing: SDF_COARSE, and how many would do. True if it was told.
bool warn_of_thinness(double thickness_mm, const Seen& seen, DiagnosticSink& sink);

/// Fewer than four samples a period: PERIOD_BELOW_SPACING. True if it was told.
bool warn_of_period(const sdf::Program& program, double spacing_mm, DiagnosticSink& sink);

/// CAVITIES_CLOSED.
void warn_of_cavities(const MeshMeasures& measures, DiagnosticSink& sink);

}  // namespace meso::operations
