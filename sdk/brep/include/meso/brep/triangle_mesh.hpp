// SPDX-License-Identifier: Apache-2.0
#pragma once
// All triangles of a meshed body, points shared: what is audited, drawn and measured.
//
//   const TriangleMesh mesh = triangle_mesh(*body);
//
// 60 bytes a triangle while it is made. Thread rule: pure.

#include "meso/base/triangle_mesh.hpp"
#include "meso/brep/body.hpp"

namespace meso::brep {

[[nodiscard]] TriangleMesh triangle_mesh(const Body& body);

}  // namespace meso::brep
