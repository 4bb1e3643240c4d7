// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "faces.hpp"
#include "meso/base/number.hpp"
#include "ply_header.hpp"
#include "readers.hpp"

namespace meso {
namespace {

static_assert(std::endian::native == std::endian::little, "the byte order that needs no turning");

template <class T>
double value_of(std::array<char, 8> bytes) {
  T value;
  std::memcpy(&value, bytes.data(), sizeof value);
  return static_cast<double>(value);
}

double value_of(PlyType type, const std::array<char, 8>& bytes) {
  switch (type) {
    case PlyType::int8:
      return value_of<std::int8_t>(bytes);
    case PlyType::uint8:
      return value_of<std::uint8_t>(bytes);
    case PlyType::int16:
      return value_of<std::int16_t>(bytes);
    case PlyType::uint16:
      return value_of<std::uint16_t>(bytes);
    case PlyType::int32:
      return value_of<std::int32_t>(bytes);
    case PlyType::uint32:
      return value_of<std::uint32_t>(bytes);
    case PlyType::float32:
      return value_of<float>(bytes);
    case PlyType::float64:
      break;
  }
  return value_of<double>(bytes);
}

/// The values of the body, one after the other, whatever their form.
class Values {
 public:
  Values(std::string_view bytes, std::string file, TextScanner& text, PlyFormat format, DiagnosticSink& sink)
      : bytes_(bytes), file_(std::move(file)), text_(text), format_(format), sink_(sink), at_(text.at()) {}

  [[nodiscard]] std::size_t remaining() const { return is_text() ? text_.remaining() + 1 : bytes_.size() - at_; }

  /// Empty, and told, where the file ends or there is no number.
  std::optional<double> next(PlyType type) {
    if (is_text()) {
      const std::string_view word = text_.word();
      const std::optional<double> value = to_number(word);
      if (!value) sink_.report(text_.expected("a number"));
      return value;
    }
    const std::size_t size = bytes_of(type);
    if (size > remaining()) {
      report(Code::mesh_file_syntax, {"a number", "the end of the file"});
      return {};
    }
    std::array<char, 8> raw{};
    std::memcpy(raw.data(), bytes_.data() + at_, size);
    if (format_ == PlyFormat::big_endian) std::reverse(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(size));
    at_ += size;
    return value_of(type, raw);
  }

  /// At the value read last, of a binary file behind it.
  bool report(Code code, std::vector<std::string> args) {
    if (is_text())
      sink_.report(text_.fault(code, std::move(args)));
    else
      sink_.report({.code = code, .where = {.file = file_, .offset = at_}, .args = std::move(args)});
    return false;
  }

 private:
  [[nodiscard]] bool is_text() const { return format_ == PlyFormat::ascii; }

  std::string_view bytes_;
  std::string file_;
  TextScanner& text_;
  PlyFormat format_;
  DiagnosticSink& sink_;
  std::size_t at_;
};

class PlyReader {
 public:
  PlyReader(const PlyHeader& header, Values& values) : header_(header), values_(values) {
    for (const PlyElement& e : header.elements) points_ += e.name == "vertex" ? e.count : 0;
  }

  std::optional<TriangleMesh> read() {
    for (const PlyElement& element : header_.elements) {
      if (element.properties.empty()) {  // no bytes; refused if triangles would refer to it
        if (element.name == "vertex" && !read_points(element)) return {};
        continue;
      }
      const std::uint64_t most = values_.remaining() / element.least_bytes(header_.format);
      if (element.count > most) {
        (void)values_.report(Code::mesh_file_truncated,
                             {std::to_string(most), std::to_string(element.count), element.name});
        return {};
      }
      const bool read = element.name == "vertex" ? read_points(element)
                        : element.name == "face" ? read_faces(element)
                                                 : skip(element);
      if (!read) return {};
    }
    mesh_.triangles = triangles_of(faces_, mesh_.points);
    return std::move(mesh_);
  }

 private:
  bool read_points(const PlyElement& element) {
    std::vector<int> axis_of(element.properties.size(), -1);
    for (int axis = 0; axis < 3; ++axis) {
      const std::optional<std::size_t> at = element.find(std::string_view("xyz").substr(std::size_t(axis), 1));
      if (!at || element.properties[*at].count_type)
        return values_.report(Code::mesh_file_unsupported, {"a vertex without x, y and z"});
      axis_of[*at] = axis;
    }
    mesh_.points.reserve(element.count);
    for (std::uint64_t n = 0; n < element.count; ++n) {
      Vec3 p;
      for (std::size_t i = 0; i < axis_of.size(); ++i) {
        if (axis_of[i] < 0) {
          if (!skip(element.properties[i])) return false;
          continue;
        }
        const std::optional<double> x = values_.next(element.properties[i].type);
        if (!x) return false;
        if (!std::isfinite(*x)) return values_.report(Code::mesh_file_not_finite, {std::to_string(n + 1)});
        p[std::size_t(axis_of[i])] = *x;
      }
      mesh_.points.push_back(p);
    }
    return true;
  }

  bool read_faces(const PlyElement& element) {
    std::optional<std::size_t> at = element.find("vertex_indices");
    if (!at) at = element.find("vertex_index");
    if (!at || !element.properties[*at].count_type || !is_whole(element.properties[*at].type))
      return values_.report(Code::mesh_file_unsupported, {"a face without a list of vertex_indices"});
    faces_.sizes.reserve(element.count);
    faces_.corners.reserve(3 * element.count);
    for (std::uint64_t n = 0; n < element.count; ++n) {
      for (std::size_t i = 0; i < element.properties.size(); ++i) {
        const PlyProperty& property = element.properties[i];
        if (!(i == *at ? read_corners(property) : skip(property))) return false;
      }
    }
    return true;
  }

  bool read_corners(const PlyProperty& property) {
    const std::optional<double> size = values_.next(*property.count_type);
    if (!size) return false;
    if (!(*size >= 3) || *size != std::floor(*size))
      return values_.report(Code::mesh_file_syntax, {"three corners or more", format_number(*size)});
    for (double i = 0; i < *size; ++i) {
      const std::optional<double> index = values_.next(property.type);
      if (!index) return false;
      if (!(*index >= 0 && *index < double(points_)) || *index != std::floor(*index))
        return values_.report(Code::mesh_file_index, {format_number(*index), std::to_string(points_)});
      faces_.corners.push_back(static_cast<std::uint32_t>(*index));
    }
    faces_.sizes.push_back(static_cast<std::uint32_t>(*size));
    return true;
  }

  bool skip(const PlyProperty& property) {
    double count = 1;
    if (property.count_type) {
      const std::optional<double> size = values_.next(*property.count_type);
      if (!size) return false;
      count = *size;
    }
    for (double i = 0; i < count; ++i) {
      if (!values_.next(property.type)) return false;
    }
    return true;
  }
  bool skip(const PlyElement& element) {
    for (std::uint64_t n = 0; n < element.count; ++n) {
      for (const PlyProperty& property : element.properties) {
        if (!skip(property)) return false;
      }
    }
    return true;
  }

  const PlyHeader& header_;
  Values& values_;
  std::uint64_t points_ = 0;
  TriangleMesh mesh_;
  Faces faces_;
};

}  // namespace

std::optional<TriangleMesh> read_ply(std::string_view bytes, const std::string& file, DiagnosticSink& sink) {
  TextScanner text(bytes, file, '\0');
  const std::optional<PlyHeader> header = read_ply_header(text, sink);
  if (!header) return {};
  Values values(bytes, file, text, header->format, sink);
  return PlyReader(*header, values).read();
}

}  // namespace meso
