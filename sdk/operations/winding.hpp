// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "meso/base/triangle_stream.hpp"

namespace meso::operations {

/// For each point: is it inside the closed surface? By the winding number, a sum of solid angles over all triangles
/// (Van Oosterom and Strackee, 1983), so the triangles stream and no index is built. Sure for points farther from the
/// surface than the triangles' deflection. Cost: points times triangles, about 20 ns each.
[[nodiscard]] std::vector<bool> inside_by_winding(const TriangleStream& triangles, std::span<const Vec3> points);

}  // namespace meso::operations
