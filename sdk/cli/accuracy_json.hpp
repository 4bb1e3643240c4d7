// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a mesh was measured to be off by, for --json.

#include "meso/operations/mesh_accuracy.hpp"
#include "run.hpp"

namespace meso::cli {

[[nodiscard]] Json accuracy_json(const operations::MeshAccuracy& accuracy);

}  // namespace meso::cli
