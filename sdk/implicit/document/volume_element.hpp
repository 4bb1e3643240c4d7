// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "meso/eval/shape.hpp"
#include "meso/implicit/field.hpp"

namespace meso::implicit {

/// All P(q) with three coordinates in ranges; nothing where the system's inverse is not known. Private.
[[nodiscard]] std::optional<Field> volume_element(const eval::VolumeElementShape& shape);
/// Between two of its corners that differ in one coordinate, the longest along each; of these the shortest.
[[nodiscard]] double shortest_edge_of(const eval::VolumeElementShape& shape);

}  // namespace meso::implicit
