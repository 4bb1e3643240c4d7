// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "faces.hpp"
#include "readers.hpp"
#include "text_scanner.hpp"

namespace meso {
namespace {

class OffReader {
 public:
  OffReader(std::string_view text, const std::string& file, DiagnosticSink& sink)
      : scanner_(text, file, '#'), sink_(sink) {}

  std::optional<TriangleMesh> read() {
    const bool read = read_header() && read_points() && read_faces();
    if (!read) return {};
    mesh_.triangles = triangles_of(faces_, mesh_.points);
    return std::move(mesh_);
  }

 private:
  bool fail(Diagnostic d) {
    sink_.report(std::move(d));
    return false;
  }

  /// [ST][C][N][4][n]OFF [BINARY], then the numbers of points, faces, and edges, which nobody counts.
  bool read_header() {
    std::string_view word = scanner_.word();
    if (word.ends_with("OFF")) {
      const std::string_view prefix = word.substr(0, word.size() - 3);
      if (prefix.find_first_of("4n") != std::string_view::npos)
        return fail(scanner_.fault(Code::mesh_file_unsupported, {"OFF with other than three coordinates"}));
      if (prefix.find_first_not_of("STCN") != std::string_view::npos) return fail(scanner_.expected("OFF"));
      word = scanner_.word();
    }
    if (word == "BINARY") return fail(scanner_.fault(Code::mesh_file_unsupported, {"binary OFF"}));
    constexpr std::size_t point_bytes = 6, face_bytes = 3;  // "0 0 0\n", "0 0" at the least
    if (!read_count(word, "points", point_bytes, points_) || !read_count(scanner_.word(), "faces", face_bytes, count_))
      return false;
    scanner_.skip_line();
    mesh_.points.reserve(points_);
    faces_.sizes.reserve(count_);
    faces_.corners.reserve(3 * count_);
    return true;
  }
  bool read_count(std::string_view word, const char* what, std::size_t least_bytes, std::size_t& count) {
    const std::optional<std::int64_t> n = to_integer(word);
    if (!n || *n < 0) return fail(scanner_.expected(std::string("the number of ") + what));
    const std::size_t most = (scanner_.remaining() + 1) / least_bytes;
    count = static_cast<std::size_t>(*n);
    if (count <= most) return true;
    return fail(scanner_.fault(Code::mesh_file_truncated, {std::to_string(most), std::to_string(count), what}));
  }

  /// Normals, colours and texture coordinates follow on the line.
  bool read_points() {
    while (mesh_.points.size() < points_) {
      Vec3 p;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::optional<double> x = to_number(i == 0 ? scanner_.word() : scanner_.word_on_line());
        if (!x) return fail(scanner_.expected("a coordinate of point " + std::to_string(mesh_.points.size() + 1)));
        if (!std::isfinite(*x))
          return fail(scanner_.fault(Code::mesh_file_not_finite, {std::to_string(mesh_.points.size() + 1)}));
        p[i] = *x;
      }
      mesh_.points.push_back(p);
      scanner_.skip_line();
    }
    return true;
  }

  bool read_faces() {
    for (std::size_t f = 0; f < count_; ++f) {
      const std::optional<std::int64_t> size = to_integer(scanner_.word());
      if (!size || *size < 3) return fail(scanner_.expected("the number of corners of face " + std::to_string(f + 1)));
      for (std::int64_t i = 0; i < *size; ++i) {
        const std::optional<std::int64_t> index = to_integer(scanner_.word_on_line());
        if (!index) return fail(scanner_.expected("a corner of face " + std::to_string(f + 1)));
        if (*index < 0 || static_cast<std::uint64_t>(*index) >= points_)
          return fail(scanner_.fault(Code::mesh_file_index, {std::to_string(*index), std::to_string(points_)}));
        faces_.corners.push_back(static_cast<std::uint32_t>(*index));
      }
      faces_.sizes.push_back(static_cast<std::uint32_t>(*size));
      scanner_.skip_line();
    }
    return true;
  }

  TextScanner scanner_;
  DiagnosticSink& sink_;
  std::size_t points_ = 0, count_ = 0;
  TriangleMesh mesh_;
  Faces faces_;
};

}  // namespace

std::optional<TriangleMesh> read_off(std::string_view text, const std::string& file, DiagnosticSink& sink) {
  return OffReader(text, file, sink).read();
}

}  // namespace meso
