// SPDX-License-Identifier: Apache-2.0
#pragma once
// Legacy VTK poly data, binary: a quarter of the size of text, and exact. Such files are big-endian.

#include "file_sink.hpp"

namespace meso {

template <class Real>
class VtkWriter final : public FileSink {
 public:
  using FileSink::FileSink;

  [[nodiscard]] bool begin() override;
  void encode_points(std::span<const Vec3> block, ByteBuffer& out) const override;
  [[nodiscard]] bool begin_triangles(std::uint64_t point_count) override;
  void encode_triangles(std::span<const IndexTriangle> block, ByteBuffer& out) const override;
  [[nodiscard]] bool finish(std::uint64_t triangle_count) override;

 private:
  std::uint64_t polygons_at_ = 0;  ///< where in the file
};

}  // namespace meso
