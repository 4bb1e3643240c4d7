// SPDX-License-Identifier: Apache-2.0
#include "accuracy_json.hpp"

namespace meso::cli {

Json accuracy_json(const operations::MeshAccuracy& accuracy) {
  return {{"distance", accuracy.distance},
          {"gridSamples", accuracy.grid_samples},
          {"surfaceSamples", accuracy.surface_samples}};
}

}  // namespace meso::cli
