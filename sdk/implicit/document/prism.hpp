// SPDX-License-Identifier: Apache-2.0
#pragma once
// Sees that an imported mesh is a profile drawn out along x, y or z: a beam, a plate, a gear. Its distance is then a
// table over the profile's plane, where a mesh is searched at every point. Private.

#include <optional>

#include "meso/base/triangle_mesh.hpp"
#include "meso/implicit/field.hpp"

namespace meso::implicit {

/// The field of the body that `mesh` bounds, or nothing if it is no prism along an axis or its profile has more than a
/// few hundred sides. The profile may have holes and several pieces. REQUIRES: a closed mesh, its normals outward.
/// Cost: O(triangles).
[[nodiscard]] std::optional<Field> prism_field(const TriangleMesh& mesh);

}  // namespace meso::implicit
