// SPDX-License-Identifier: Apache-2.0
#pragma once
// STL, which has no shared points: keeps 12 bytes a point until its triangles have been written. A triangle that
// rounding to floats folds up is left out (see write_stl.hpp).

#include <memory>
#include <vector>

#include "file_sink.hpp"
#include "meso/export_stl/stl_facet.hpp"

namespace meso {

class StlWriter final : public FileSink {
 public:
  StlWriter(OutputFile& file, StlFormat format) : FileSink(file), format_(format) {}

  [[nodiscard]] bool begin() override;
  void encode_points(std::span<const Vec3> block, ByteBuffer& out) const override;
  [[nodiscard]] bool write_points(std::string_view bytes) override;
  void encode_triangles(std::span<const IndexTriangle> block, ByteBuffer& out) const override;
  [[nodiscard]] bool write_triangles(std::string_view bytes) override;
  [[nodiscard]] bool finish(std::uint64_t triangle_count) override;

  [[nodiscard]] std::uint64_t bytes_per_point() const override { return sizeof(StlPoint); }

 private:
  // In pieces, because a vector that grows holds everything twice.
  static constexpr std::size_t piece = std::size_t{1} << 16;

  [[nodiscard]] const StlPoint& at(std::uint32_t i) const { return pieces_[i / piece][i % piece]; }

  StlFormat format_;
  std::vector<std::unique_ptr<StlPoint[]>> pieces_;
  std::size_t kept_ = 0;
  std::uint64_t facet_bytes_ = 0;
};

}  // namespace meso
