// SPDX-License-Identifier: Apache-2.0
#pragma once
// A mesh as distances need it: loose triangles in spatial order, with what is twice or turned over put right. No point
// is moved.

#include <optional>
#include <vector>

#include "meso/base/diagnostic.hpp"
#include "meso/base/triangle_stream.hpp"
#include "meso/mesh_distance/mesh_quality.hpp"
#include "stop_poll.hpp"

namespace meso::implicit {

struct CleanMesh {
  std::vector<Triangle> triangles;
  Box3 box;
  MeshQuality quality;
};

/// Coordinates below 1e-60 become 0: products of three of them must not underflow.
[[nodiscard]] Vec3 without_specks(Vec3 p);

/// Empty after MESH_EMPTY or MESH_COORDINATES, or if stopped. Reports what it finds as MESH_NOT_CLOSED, ... warnings.
[[nodiscard]] std::optional<CleanMesh> clean_mesh(const TriangleMesh& mesh, const std::string& name, StopPoll& stop,
                                                  DiagnosticSink& sink);

}  // namespace meso::implicit
