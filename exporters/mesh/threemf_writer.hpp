// SPDX-License-Identifier: Apache-2.0
#pragma once
// 3MF: one object of one mesh, in millimetres, where the document has it (3MF Core Specification 1.3, chapters 2 and
// 4). The model is text that is compressed when all of it is known, so until then it stands in a temporary file.

#include <cstdio>
#include <memory>

#include "file_sink.hpp"

namespace meso {

template <class Real>
class ThreeMfWriter final : public FileSink {
 public:
  using FileSink::FileSink;

  [[nodiscard]] bool begin() override;
  void encode_points(std::span<const Vec3> block, ByteBuffer& out) const override;
  [[nodiscard]] bool write_points(std::string_view bytes) override { return put(bytes); }
  [[nodiscard]] bool begin_triangles(std::uint64_t point_count) override;
  void encode_triangles(std::span<const IndexTriangle> block, ByteBuffer& out) const override;
  [[nodiscard]] bool write_triangles(std::string_view bytes) override { return put(bytes); }
  [[nodiscard]] bool finish(std::uint64_t triangle_count) override;

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  bool put(std::string_view text);

  std::unique_ptr<std::FILE, Close> model_;
};

}  // namespace meso
