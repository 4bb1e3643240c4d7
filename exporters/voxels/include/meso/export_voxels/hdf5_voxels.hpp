// SPDX-License-Identifier: Apache-2.0
#pragma once
// An array of voxels as an HDF5 file.
//
//   Hdf5Voxels writer(file->temporary_path());   // of an OutputFile
//   if (sample_voxels(..., writer, ...) && file->commit(sink)) ...
//
// One dataset, named as the array is, with z, y, x as its dimensions (C order) and the attributes origin_mm and
// spacing_mm (x, y, z). Chunked by plane, shuffled and deflated; no times are kept, so equal arrays give equal bytes.

#include <cstdint>
#include <string>

#include "meso/base/voxel_sink.hpp"

namespace meso {

class Hdf5Voxels final : public VoxelSink {
 public:
  /// Writes the file at `path`, which may exist.
  explicit Hdf5Voxels(std::string path) : path_(std::move(path)) {}
  ~Hdf5Voxels() override;

  [[nodiscard]] bool begin(const VoxelArray& array) override;
  [[nodiscard]] bool write_plane(std::string_view bytes) override;
  [[nodiscard]] bool finish() override;

 private:
  void close();

  std::string path_;
  VoxelArray array_;
  std::uint64_t plane_ = 0;
  std::int64_t file_ = -1, dataset_ = -1;  // HDF5's handles
};

}  // namespace meso
