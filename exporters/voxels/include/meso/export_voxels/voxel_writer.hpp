// SPDX-License-Identifier: Apache-2.0
#pragma once
// Arrays of voxels as files: NRRD and VTI.
//
//   auto file = OutputFile::create("part.nrrd", ExistingFile::replace, sink);
//   const auto writer = make_voxel_writer(VoxelFormat::nrrd, *file);
//   if (sample_voxels(*source, voxels, VoxelValue::density, *writer, run, sink) && file->commit(sink)) ...
//
// NRRD: one file, raw; cell-centred, in a right-handed space of millimetres. VTI: image data with one array of cells,
// raw appended. Both are streamed plane by plane. HDF5 is a room of its own (hdf5_voxels.hpp).

#include <memory>
#include <optional>
#include <string_view>

#include "meso/base/byte_sink.hpp"
#include "meso/base/voxel_sink.hpp"

namespace meso {

enum class VoxelFormat { nrrd, vti };

/// By the ending of a file's name, upper or lower case: .nrrd .vti.
[[nodiscard]] std::optional<VoxelFormat> voxel_format_of(std::string_view path);

/// `file` must outlive the writer.
[[nodiscard]] std::unique_ptr<VoxelSink> make_voxel_writer(VoxelFormat format, ByteSink& file);

}  // namespace meso
