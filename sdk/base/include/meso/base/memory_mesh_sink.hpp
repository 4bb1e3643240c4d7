// SPDX-License-Identifier: Apache-2.0
#pragma once
// A mesh sink that keeps the mesh.
//
//   TriangleMesh mesh;
//   MemoryMeshSink sink(mesh);   // whoever streams into it fills `mesh`

#include "meso/base/mesh_sink.hpp"
#include "meso/base/triangle_mesh.hpp"

namespace meso {

class MemoryMeshSink : public MeshSink {
 public:
  explicit MemoryMeshSink(TriangleMesh& mesh) : mesh_(mesh) {}

  [[nodiscard]] bool begin() override;
  void encode_points(std::span<const Vec3> block, ByteBuffer& out) const override;
  [[nodiscard]] bool write_points(std::string_view bytes) override;
  [[nodiscard]] bool begin_triangles(std::uint64_t point_count) override;
  void encode_triangles(std::span<const IndexTriangle> block, ByteBuffer& out) const override;
  [[nodiscard]] bool write_triangles(std::string_view bytes) override;
  [[nodiscard]] bool finish(std::uint64_t triangle_count) override;

  [[nodiscard]] std::uint64_t bytes_per_point() const override { return sizeof(Vec3); }
  [[nodiscard]] std::uint64_t bytes_per_triangle() const override { return sizeof(IndexTriangle); }

 private:
  TriangleMesh& mesh_;
};

/// Streams a mesh that is in memory. False if the sink failed.
[[nodiscard]] bool write_mesh(const TriangleMesh& mesh, MeshSink& sink);

}  // namespace meso
