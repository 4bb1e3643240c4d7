// SPDX-License-Identifier: Apache-2.0
#include "meso/import_surface_mesh/read_stl.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "meso/import_surface_mesh/weld.hpp"

namespace meso {
namespace {

static_assert(std::endian::native == std::endian::little, "binary STL is little-endian");

constexpr std::size_t header_bytes = 84, facet_bytes = 50;

bool is_finite(Vec3 p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

class BinaryReader {
 public:
  BinaryReader(std::string_view bytes, const std::string& file, DiagnosticSink& sink)
      : bytes_(bytes), file_(file), sink_(sink) {}

  std::optional<TriangleMesh> read() {
    const std::uint64_t count = announced(bytes_);
    const std::uint64_t present = bytes_.size() < header_bytes ? 0 : (bytes_.size() - header_bytes) / facet_bytes;
    if (bytes_.size() < header_bytes || present < count) {
      fail(Code::stl_truncated, {std::to_string(present), std::to_string(count)});
      return std::nullopt;
    }
    if (const std::uint64_t extra = bytes_.size() - header_bytes - count * facet_bytes; extra > 0) {
      fail(Code::stl_extra_bytes, {std::to_string(extra), std::to_string(count)});
      return std::nullopt;
    }
    weld_.reserve(count);
    for (std::uint64_t i = 0; i < count; ++i)
      if (!add_facet(i)) return std::nullopt;
    return std::move(weld_).mesh();
  }

  [[nodiscard]] static std::uint32_t announced(std::string_view bytes) {
    std::uint32_t count = 0;
    if (bytes.size() >= header_bytes) std::memcpy(&count, bytes.data() + 80, sizeof count);
    return count;
  }

 private:
  bool add_facet(std::uint64_t index) {
    constexpr std::size_t normal_bytes = 12;
    std::array<float, 9> f;
    std::memcpy(f.data(), bytes_.data() + header_bytes + index * facet_bytes + normal_bytes, sizeof f);
    const Vec3 a{f[0], f[1], f[2]}, b{f[3], f[4], f[5]}, c{f[6], f[7], f[8]};
    if (is_finite(a) && is_finite(b) && is_finite(c)) {
      weld_.add(a, b, c);
      return true;
    }
    fail(Code::stl_not_finite, {std::to_string(index + 1)});
    return false;
  }
  void fail(Code code, std::vector<std::string> args) {
    sink_.report({.code = code, .where = {.file = file_}, .args = std::move(args)});
  }

  std::string_view bytes_;
  const std::string& file_;
  DiagnosticSink& sink_;
  Weld weld_;
};

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c; }

bool equal_ignoring_case(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, [](char x, char y) { return lower(x) == lower(y); });
}

/// `solid NAME` { facet normal n outer loop vertex v vertex v vertex v endloop endfacet } `endsolid NAME`, repeated.
class AsciiReader {
 public:
  AsciiReader(std::string_view text, const std::string& file, DiagnosticSink& sink)
      : text_(text), file_(file), sink_(sink) {}

  std::optional<TriangleMesh> read() {
    while (ok_ && !next_word().empty()) read_solid();
    if (!ok_) return std::nullopt;
    return std::move(weld_).mesh();
  }

 private:
  void read_solid() {
    expect(word_, "solid");
    skip_line();
    while (ok_ && equal_ignoring_case(next_word(), "facet")) read_facet();
    expect(word_, "endsolid");
    skip_line();
  }

  void read_facet() {
    expect(next_word(), "normal");
    for (int i = 0; i < 3; ++i) (void)number();
    expect(next_word(), "outer");
    expect(next_word(), "loop");
    std::array<Vec3, 3> corners;
    for (Vec3& corner : corners) {
      expect(next_word(), "vertex");
      for (std::size_t i = 0; i < 3; ++i) corner[i] = number();
    }
    expect(next_word(), "endloop");
    expect(next_word(), "endfacet");
    ++facets_;
    if (!ok_) return;
    if (std::ranges::all_of(corners, is_finite))
      weld_.add(corners[0], corners[1], corners[2]);
    else
      fail(Code::stl_not_finite, {std::to_string(facets_)});
  }

  std::string_view next_word() {
    constexpr std::string_view space = " \t\r\n\f\v";
    const std::size_t begin = std::min(text_.find_first_not_of(space, at_), text_.size());
    at_ = std::min(text_.find_first_of(space, begin), text_.size());
    return word_ = text_.substr(begin, at_ - begin);
  }
  void skip_line() { at_ = std::min(text_.find('\n', at_), text_.size()); }

  void expect(std::string_view word, std::string_view wanted) {
    if (ok_ && !equal_ignoring_case(word, wanted)) fail(Code::stl_syntax, {std::string(wanted), shortened(word)});
  }

  double number() {
    std::string_view word = next_word();
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    // Too small a number is zero to everybody else; too large a one is caught as not finite.
    const bool read = error == std::errc{} || error == std::errc::result_out_of_range;
    if (ok_ && (!read || end != word.data() + word.size())) fail(Code::stl_syntax, {"a number", shortened(word)});
    return error == std::errc::result_out_of_range ? out_of_range(word) : value;
  }
  static double out_of_range(std::string_view word) {
    return word.find("e-") != std::string_view::npos || word.find("E-") != std::string_view::npos ? 0 : HUGE_VAL;
  }

  static std::string shortened(std::string_view word) {
    return word.empty() ? "the end of the file" : std::string(word.substr(0, 40));
  }

  void fail(Code code, std::vector<std::string> args) {
    ok_ = false;
    const std::size_t offset = static_cast<std::size_t>(word_.data() - text_.data());
    const std::string_view before = text_.substr(0, offset);
    const auto line = 1 + std::ranges::count(before, '\n');
    const std::size_t line_start = before.find_last_of('\n') + 1;  // npos + 1 is 0
    sink_.report({.code = code, .where = place(offset, line, offset - line_start + 1), .args = std::move(args)});
  }
  [[nodiscard]] SourceSpan place(std::size_t offset, std::ptrdiff_t line, std::size_t column) const {
    SourceSpan span;
    span.file = file_;
    span.offset = offset;
    span.length = word_.size();
    span.line = static_cast<decltype(span.line)>(line);
    span.column = static_cast<decltype(span.column)>(column);
    return span;
  }

  std::string_view text_;
  const std::string& file_;
  DiagnosticSink& sink_;
  Weld weld_;
  std::string_view word_;
  std::size_t at_ = 0;
  std::uint64_t facets_ = 0;
  bool ok_ = true;
};

// "solid" also begins many a binary header, so the size decides first.
bool is_binary(std::string_view bytes) {
  const bool fits = bytes.size() >= header_bytes &&
                    bytes.size() == header_bytes + std::uint64_t{BinaryReader::announced(bytes)} * facet_bytes;
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  return fits || first == std::string_view::npos || !equal_ignoring_case(bytes.substr(first, 5), "solid");
}

}  // namespace

std::optional<TriangleMesh> read_stl(std::string_view bytes, const std::string& file, DiagnosticSink& sink) {
  std::optional<TriangleMesh> mesh =
      is_binary(bytes) ? BinaryReader(bytes, file, sink).read() : AsciiReader(bytes, file, sink).read();
  if (mesh && mesh->triangles.empty()) {
    sink.report({.code = Code::stl_empty, .where = {.file = file}});
    mesh.reset();
  }
  return mesh;
}

}  // namespace meso
