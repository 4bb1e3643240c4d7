// SPDX-License-Identifier: Apache-2.0
#pragma once
// Measures a mesh on its way into a sink: volume, area, pieces, whether it is closed.
//
//   MeasuredMeshSink<float> measured(*writer);   // as the file has its coordinates
//   contour(*source, measured, ...);
//   measured.measures(0).volume
//
// Keeps the points, and for each a number and a volume: 24 bytes, 36 of doubles. Measures are the same for any number
// of threads as long as the blocks are.

#include <array>
#include <vector>

#include "meso/base/mesh_sink.hpp"
#include "meso/operations/mesh_measures.hpp"

namespace meso::operations {

template <class Real>
class MeasuredMeshSink final : public MeshSink {
 public:
  explicit MeasuredMeshSink(MeshSink& into) : into_(into) {}

  [[nodiscard]] bool begin() override { return into_.begin(); }
  void encode_points(std::span<const Vec3> block, ByteBuffer& out) const override;
  [[nodiscard]] bool write_points(std::string_view bytes) override;
  [[nodiscard]] bool begin_triangles(std::uint64_t point_count) override;
  void encode_triangles(std::span<const IndexTriangle> block, ByteBuffer& out) const override;
  [[nodiscard]] bool write_triangles(std::string_view bytes) override;
  [[nodiscard]] bool finish(std::uint64_t triangle_count) override { return into_.finish(triangle_count); }

  [[nodiscard]] std::uint64_t max_points() const override { return into_.max_points(); }
  /// The points' list grows by doubling.
  [[nodiscard]] std::uint64_t bytes_per_point() const override {
    return into_.bytes_per_point() + 2 * sizeof(Point) + sizeof(std::uint32_t) + sizeof(double);
  }
  [[nodiscard]] std::uint64_t bytes_per_triangle() const override { return into_.bytes_per_triangle(); }

  /// Once finish() has been called. Shells that enclose less than `crumb` are counted apart.
  [[nodiscard]] MeshMeasures measures(double crumb) const;

 private:
  using Point = std::array<Real, 3>;

  [[nodiscard]] Vec3 point(std::uint32_t i) const { return {points_[i][0], points_[i][1], points_[i][2]}; }
  [[nodiscard]] std::uint32_t root(std::uint32_t point);
  [[nodiscard]] std::uint32_t join(const IndexTriangle& t);

  MeshSink& into_;
  std::vector<Point> points_;
  std::vector<std::uint32_t> parents_;  // of a forest; the roots are the shells
  std::vector<double> enclosed_;        // by the triangles of a root
  MeshMeasures measures_;
  std::uint64_t edge_balance_ = 0;
};

/// Where a mesh ends that is only measured.
class NoMesh final : public MeshSink {
 public:
  [[nodiscard]] bool begin() override { return true; }
  void encode_points(std::span<const Vec3>, ByteBuffer&) const override {}
  [[nodiscard]] bool write_points(std::string_view) override { return true; }
  [[nodiscard]] bool begin_triangles(std::uint64_t) override { return true; }
  void encode_triangles(std::span<const IndexTriangle>, ByteBuffer&) const override {}
  [[nodiscard]] bool write_triangles(std::string_view) override { return true; }
  [[nodiscard]] bool finish(std::uint64_t) override { return true; }
};

}  // namespace meso::operations
