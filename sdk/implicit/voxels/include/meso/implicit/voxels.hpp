// SPDX-License-Identifier: Apache-2.0
#pragma once
// A solid as an array of voxels.
//
//   const VoxelGrid voxels{.box = box, .cells = {100, 100, 100}, .subsamples = {4, 4, 4}};
//   const auto source = compile(term, voxels.samples());
//   sample_voxels(*source, voxels, VoxelValue::density, sink, run, diagnostics);
//
// A voxel is a cell of the box, and its samples are the middles of its parts. Constant memory: 16 planes. Equal bytes
// for any number of threads. Errors: LIMIT_GRID_MEMORY, LIMIT_TIME, CANCELLED; a sink that failed is reported by its
// owner.

#include <array>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/base/voxel_sink.hpp"
#include "meso/implicit/grid_source.hpp"

namespace meso::implicit {

enum class VoxelValue : std::uint8_t {
  occupancy,  ///< 1 where more than half of the samples are inside, else 0
  density,    ///< the share of samples inside, 0 to 1
  grey,       ///< the same, 0 to 255, rounded
  distance    ///< the field's value in the middle, negative inside; not finite where it has none
};

struct VoxelGrid {
  Box3 box;
  std::array<std::int32_t, 3> cells{1, 1, 1};
  std::array<std::int32_t, 3> subsamples{1, 1, 1};

  /// Where the solid is sampled. Along an axis with a single sample there is a second one at the box's end, unused.
  [[nodiscard]] Grid samples() const;
};

/// REQUIRES: a source on voxels.samples(); for distance, no subsamples.
[[nodiscard]] bool sample_voxels(const GridSource& source, const VoxelGrid& voxels, VoxelValue value, VoxelSink& sink,
                                 const RunOptions& run, DiagnosticSink& diagnostics);

}  // namespace meso::implicit
