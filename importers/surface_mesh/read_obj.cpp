// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "faces.hpp"
#include "readers.hpp"
#include "text_scanner.hpp"

namespace meso {
namespace {

class ObjReader {
 public:
  ObjReader(std::string_view text, const std::string& file, DiagnosticSink& sink)
      : scanner_(text, file, '#'), sink_(sink) {}

  std::optional<TriangleMesh> read() {
    while (scanner_.remaining() > 0) {
      const std::string_view keyword = word();
      const bool read = keyword == "v" ? read_point() : keyword == "f" ? read_face() : true;
      if (!read) return {};
      while (!word().empty()) {
      }
      scanner_.skip_line();
    }
    if (const auto points = static_cast<std::int64_t>(mesh_.points.size()); largest_ > points) {
      const std::vector<std::string> args{std::to_string(largest_), std::to_string(points)};
      (void)fail(scanner_.fault_at(largest_word_, Code::mesh_file_index, args));
      return {};
    }
    mesh_.triangles = triangles_of(faces_, mesh_.points);
    return std::move(mesh_);
  }

 private:
  bool fail(Diagnostic d) {
    sink_.report(std::move(d));
    return false;
  }

  /// The next word of this line, or of the one that a backslash continues it with.
  std::string_view word() {
    std::string_view w = scanner_.word_on_line();
    while (w == "\\") {
      scanner_.skip_line();
      w = scanner_.word_on_line();
    }
    return w;
  }

  bool read_point() {
    Vec3 p;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::optional<double> x = to_number(word());
      if (!x) return fail(scanner_.expected("a number"));
      if (!std::isfinite(*x))
        return fail(scanner_.fault(Code::mesh_file_not_finite, {std::to_string(mesh_.points.size() + 1)}));
      p[i] = *x;
    }
    mesh_.points.push_back(p);
    return true;
  }

  /// f POINT[/TEXTURE[/NORMAL]] ..., counted from 1, or from the last one with -1.
  bool read_face() {
    std::uint32_t size = 0;
    for (std::string_view w = word(); !w.empty(); w = word(), ++size) {
      const std::optional<std::int64_t> index = to_integer(w.substr(0, w.find('/')));
      if (!index) return fail(scanner_.expected("the number of a point"));
      const auto points = static_cast<std::int64_t>(mesh_.points.size());
      const std::int64_t number = *index < 0 ? points + 1 + *index : *index;
      if (number < 1 || number > most_points)
        return fail(scanner_.fault(Code::mesh_file_index, {std::to_string(*index), std::to_string(points)}));
      // Points may follow the faces that use them.
      if (number > points && number > largest_) {
        largest_ = number;
        largest_word_ = w;
      }
      faces_.corners.push_back(static_cast<std::uint32_t>(number - 1));
    }
    if (size < 3) return fail(scanner_.expected("three corners or more"));
    faces_.sizes.push_back(size);
    return true;
  }

  static constexpr std::int64_t most_points = 0xffffffff;
  TextScanner scanner_;
  DiagnosticSink& sink_;
  TriangleMesh mesh_;
  Faces faces_;
  std::int64_t largest_ = 0;  // number of a point that is used before it is given
  std::string_view largest_word_;
};

}  // namespace

std::optional<TriangleMesh> read_obj(std::string_view text, const std::string& file, DiagnosticSink& sink) {
  return ObjReader(text, file, sink).read();
}

}  // namespace meso
