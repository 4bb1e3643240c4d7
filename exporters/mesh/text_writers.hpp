// SPDX-License-Identifier: Apache-2.0
#pragma once
// OBJ and OFF: a line for every point and every triangle. Coordinates are the shortest text of their float or double.

#include "file_sink.hpp"

namespace meso {

template <class Real>
class ObjWriter final : public FileSink {
 public:
  using FileSink::FileSink;

  [[nodiscard]] bool begin() override;
  void encode_points(std::span<const Vec3> block, ByteBuffer& out) const override;
  void encode_triangles(std::span<const IndexTriangle> block, ByteBuffer& out) const override;
  [[nodiscard]] bool finish(std::uint64_t triangle_count) override;
};

template <class Real>
class OffWriter final : public FileSink {
 public:
  using FileSink::FileSink;

  [[nodiscard]] bool begin() override;
  void encode_points(std::span<const Vec3> block, ByteBuffer& out) const override;
  void encode_triangles(std::span<const IndexTriangle> block, ByteBuffer& out) const override;
  [[nodiscard]] bool finish(std::uint64_t triangle_count) override;
};

}  // namespace meso
