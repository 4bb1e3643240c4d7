// SPDX-License-Identifier: Apache-2.0
#pragma once
// What all writers of mesh files share: bytes go to the end of the file as they come.

#include "meso/base/mesh_sink.hpp"
#include "meso/base/output_file.hpp"

namespace meso {

class FileSink : public MeshSink {
 public:
  explicit FileSink(OutputFile& file) : file_(file) {}

  [[nodiscard]] bool write_points(std::string_view bytes) override { return file_.write(bytes); }
  [[nodiscard]] bool begin_triangles(std::uint64_t point_count) override {
    points_ = point_count;
    return true;
  }
  [[nodiscard]] bool write_triangles(std::string_view bytes) override { return file_.write(bytes); }

 protected:
  OutputFile& file_;
  std::uint64_t points_ = 0;
};

}  // namespace meso
