// SPDX-License-Identifier: Apache-2.0
#pragma once
// The distance to a body between plane faces. Private.

#include <optional>

#include "meso/base/polyhedron.hpp"
#include "meso/base/run_options.hpp"
#include "meso/base/triangle_mesh.hpp"
#include "meso/implicit/field.hpp"

namespace meso::implicit {

/// Exact within; outside of a convex body the distance to the farthest of its planes, else exact. Nothing if there is
/// no room or time. REQUIRES: a polyhedron without fault.
[[nodiscard]] std::optional<Field> polyhedron_field(const Polyhedron& polyhedron, const RunOptions& run,
                                                    DiagnosticSink& sink);

/// The same faces, divided: each triangle between corners of one face.
[[nodiscard]] TriangleMesh triangles_of(const Polyhedron& polyhedron);

}  // namespace meso::implicit
