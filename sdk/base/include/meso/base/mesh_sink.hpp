// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where a mesh of any size goes, block by block: a file of some format, or memory.
//
// Blocks are encoded by many threads at once and written by one at a time, in order:
//
//   sink.begin();
//   sink.encode_points(block, bytes);     // any thread, any time, no state
//   sink.write_points(bytes.view());      // in the order of the points
//   sink.begin_triangles(point_count);
//   sink.encode_triangles(block, bytes);  // as above
//   sink.write_triangles(bytes.view());
//   sink.finish(triangle_count);
//
// Bytes of consecutive blocks may be joined before they are written. A function that returns false has failed: the mesh
// is abandoned, and the sink's owner reports why. Meshes have at most max_points() points.

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "meso/base/byte_buffer.hpp"
#include "meso/base/vec.hpp"

namespace meso {

/// Indices of points, counter-clockwise seen from outside.
using IndexTriangle = std::array<std::uint32_t, 3>;

class MeshSink {
 public:
  MeshSink() = default;
  MeshSink(const MeshSink&) = delete;
  MeshSink& operator=(const MeshSink&) = delete;
  virtual ~MeshSink() = default;

  [[nodiscard]] virtual bool begin() = 0;
  virtual void encode_points(std::span<const Vec3> block, ByteBuffer& out) const = 0;
  [[nodiscard]] virtual bool write_points(std::string_view bytes) = 0;
  [[nodiscard]] virtual bool begin_triangles(std::uint64_t point_count) = 0;
  virtual void encode_triangles(std::span<const IndexTriangle> block, ByteBuffer& out) const = 0;
  [[nodiscard]] virtual bool write_triangles(std::string_view bytes) = 0;
  [[nodiscard]] virtual bool finish(std::uint64_t triangle_count) = 0;

  /// Most formats store indices in 32 bits with a sign.
  [[nodiscard]] virtual std::uint64_t max_points() const { return 0x7fffffff; }
  /// What the sink keeps in memory, for estimates.
  [[nodiscard]] virtual std::uint64_t bytes_per_point() const { return 0; }
  [[nodiscard]] virtual std::uint64_t bytes_per_triangle() const { return 0; }
};

}  // namespace meso
