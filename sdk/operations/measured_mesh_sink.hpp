// SPDX-License-Identifier: Apache-2.0
#pragma once
// Measures a mesh on its way into a sink: volume, area, pieces, whether it is closed.
//
//   MeasuredMeshSink measured(*writer);
//   contour(*source, measured, ...);
//   measured.measures().volume
//
// Keeps the points as floats and one number a point: 16 bytes each. Measures are the same for any number of threads as
// long as the blocks are.

#include <array>
#include <vector>

#include "meso/base/mesh_sink.hpp"
#include "meso/operations/mesh_measures.hpp"

namespace meso::operations {

class MeasuredMeshSink final : public MeshSink {
 public:
  explicit MeasuredMeshSink(MeshSink& into) : into_(into) {}

  [[nodiscard]] bool begin() override { return into_.begin(); }
  void encode_points(std::span<const Vec3> block, ByteBuffer& out) const override;
  [[nodiscard]] bool write_points(std::string_view bytes) override;
  [[nodiscard]] bool begin_triangles(std::uint64_t point_count) override;
  void encode_triangles(std::span<const IndexTriangle> block, ByteBuffer& out) const override;
  [[nodiscard]] bool write_triangles(std::string_view bytes) override;
  [[nodiscard]] bool finish(std::uint64_t triangle_count) override;

  [[nodiscard]] std::uint64_t max_points() const override { return into_.max_points(); }
  [[nodiscard]] std::uint64_t bytes_per_point() const override { return into_.bytes_per_point() + 16; }
  [[nodiscard]] std::uint64_t bytes_per_triangle() const override { return into_.bytes_per_triangle(); }

  /// Once finish() has been called.
  [[nodiscard]] MeshMeasures measures() const;

 private:
  [[nodiscard]] std::uint32_t root(std::uint32_t point);

  MeshSink& into_;
  std::vector<std::array<float, 3>> points_;
  std::vector<std::uint32_t> parents_;  // of a forest; the roots are the pieces
  MeshMeasures measures_;
  std::uint64_t edge_balance_ = 0;
};

}  // namespace meso::operations
