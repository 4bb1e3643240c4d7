// SPDX-License-Identifier: Apache-2.0
#pragma once
// What every volume is made from: a field, a box, and how finely to sample it. Private.

#include "file_extension.hpp"
#include "meso/implicit/compile.hpp"
#include "meso/implicit/field.hpp"
#include "meso/operations/volume_outputs.hpp"

namespace meso::operations {

struct VolumeJob {
  const std::string& path;
  const VolumeOptions& options;
  implicit::Field field;
  Box3 box;
  std::array<std::int32_t, 3> samples{};
  DiagnosticSink& sink;
  const sdf::Program* words = nullptr;  ///< that the field was made from, if it was
  VolumeReport report{};

  /// Nothing: stopped, reported.
  [[nodiscard]] std::unique_ptr<implicit::GridSource> source(const implicit::Field& of,
                                                             const implicit::Grid& grid) const {
    return implicit::compile(of.term(), grid, {.strict_math = options.strict_math}, options.run, sink);
  }
  bool refuse(const std::string& why) const {
    sink.report({.code = Code::usage, .args = {why}});
    return false;
  }
};

/// False: reported.
[[nodiscard]] bool write_tetrahedra(VolumeJob& job);
[[nodiscard]] bool write_voxels(VolumeJob& job);
[[nodiscard]] bool write_slices(VolumeJob& job);

}  // namespace meso::operations
