// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where an array of voxels goes, plane by plane: a file of some format, or memory.
//
//   sink.begin({.cells = {40, 40, 40}, .origin = {}, .spacing = {0.1, 0.1, 0.1}, .type = VoxelType::uint8});
//   for (each plane along z) sink.write_plane(bytes);   // x fastest, little-endian
//   sink.finish();
//
// A function that returns false has failed, and the sink's owner reports why.

#include <array>
#include <cstdint>
#include <string_view>

#include "meso/base/vec.hpp"

namespace meso {

enum class VoxelType : std::uint8_t { uint8, float32 };

struct VoxelArray {
  std::array<std::uint32_t, 3> cells{};
  Vec3 origin;   ///< the corner of the first cell with the least coordinates, millimetres
  Vec3 spacing;  ///< a cell's size
  VoxelType type = VoxelType::uint8;
  std::string_view name = "occupancy";

  [[nodiscard]] std::uint64_t plane_bytes() const {
    return std::uint64_t{cells[0]} * cells[1] * (type == VoxelType::uint8 ? 1 : 4);
  }
  [[nodiscard]] std::uint64_t bytes() const { return plane_bytes() * cells[2]; }
};

class VoxelSink {
 public:
  VoxelSink() = default;
  VoxelSink(const VoxelSink&) = delete;
  VoxelSink& operator=(const VoxelSink&) = delete;
  virtual ~VoxelSink() = default;

  [[nodiscard]] virtual bool begin(const VoxelArray& array) = 0;
  [[nodiscard]] virtual bool write_plane(std::string_view bytes) = 0;
  [[nodiscard]] virtual bool finish() = 0;
};

}  // namespace meso
