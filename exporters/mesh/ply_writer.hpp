// SPDX-License-Identifier: Apache-2.0
#pragma once
// Binary little-endian PLY.

#include "meso/base/mesh_sink.hpp"
#include "meso/base/output_file.hpp"

namespace meso {

template <class Real>
class PlyWriter final : public MeshSink {
 public:
  explicit PlyWriter(OutputFile& file) : file_(file) {}

  [[nodiscard]] bool begin() override;
  void encode_points(std::span<const Vec3> block, ByteBuffer& out) const override;
  [[nodiscard]] bool write_points(std::string_view bytes) override;
  [[nodiscard]] bool begin_triangles(std::uint64_t point_count) override;
  void encode_triangles(std::span<const IndexTriangle> block, ByteBuffer& out) const override;
  [[nodiscard]] bool write_triangles(std::string_view bytes) override;
  [[nodiscard]] bool finish(std::uint64_t triangle_count) override;

 private:
  OutputFile& file_;
  std::uint64_t points_ = 0;
};

}  // namespace meso
