// SPDX-License-Identifier: Apache-2.0
#pragma once
// Slices as pictures: a stack of PNG files, or SVG.
//
//   write_slice_svg(slice, {.min = {-1, -1}, .max = {1, 1}}, *file);
//   PngStack stack([&](std::uint32_t plane) { return OutputFile::create(...); });   // a VoxelSink
//
// SVG: one path of the even-odd rule, black on nothing, in millimetres, the second axis upward. PNG: 8 bits of grey,
// one pixel a voxel, 255 where there is solid, the second axis upward, and the pixels' size.

#include <array>
#include <functional>
#include <memory>

#include "meso/base/byte_sink.hpp"
#include "meso/base/slice.hpp"
#include "meso/base/voxel_sink.hpp"

namespace meso {

struct SliceFrame {
  std::array<double, 2> min{}, max{};  ///< of the box, millimetres
};

[[nodiscard]] bool write_slice_svg(const Slice& slice, const SliceFrame& frame, ByteSink& file);

/// One file for each plane of an array of bytes.
class PngStack final : public VoxelSink {
 public:
  /// Takes the whole file of one plane. False: failed.
  using Take = std::function<bool(std::uint32_t plane, std::string_view bytes)>;
  explicit PngStack(Take take) : take_(std::move(take)) {}

  /// REQUIRES: an array of uint8.
  [[nodiscard]] bool begin(const VoxelArray& array) override;
  [[nodiscard]] bool write_plane(std::string_view bytes) override;
  [[nodiscard]] bool finish() override { return true; }

 private:
  Take take_;
  VoxelArray array_;
  std::uint32_t plane_ = 0;
};

}  // namespace meso
