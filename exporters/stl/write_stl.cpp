// SPDX-License-Identifier: Apache-2.0
#include "meso/export_stl/write_stl.hpp"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

namespace meso {
namespace {

static_assert(std::endian::native == std::endian::little, "binary STL is little-endian");

using Point = std::array<float, 3>;
using Facet = std::array<Point, 3>;

Facet to_facet(const Triangle& t) {
  Facet facet;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < 3; ++i) facet[k][i] = static_cast<float>(t[k][i]) + 0.0F;  // + 0: one zero, not two
  return facet;
}

bool is_folded(const Facet& f) { return f[0] == f[1] || f[1] == f[2] || f[2] == f[0]; }

// From the corners as written, so that reader and writer agree; zero where they are collinear.
Point normal_of(const Facet& f) {
  const auto vec = [](const Point& p) { return Vec3{p[0], p[1], p[2]}; };
  const Vec3 n = cross(vec(f[1]) - vec(f[0]), vec(f[2]) - vec(f[0]));
  const double length = norm(n);
  if (!(length > 0)) return {0, 0, 0};
  return {static_cast<float>(n.x / length) + 0.0F, static_cast<float>(n.y / length) + 0.0F,
          static_cast<float>(n.z / length) + 0.0F};
}

class Buffer {
 public:
  explicit Buffer(ByteSink& sink) : sink_(sink), bytes_(size_t{1} << 20) {}

  /// Room for `count` more bytes.
  char* claim(std::size_t count) {
    if (bytes_.size() - used_ < count) flush();
    return bytes_.data() + used_;
  }
  void advance(std::size_t count) { used_ += count; }
  void put(std::string_view text) {
    std::memcpy(claim(text.size()), text.data(), text.size());
    advance(text.size());
  }
  void flush() {
    ok_ = ok_ && sink_.write({bytes_.data(), used_});
    flushed_ += used_;
    used_ = 0;
  }
  [[nodiscard]] std::uint64_t total() const { return flushed_ + used_; }
  [[nodiscard]] bool ok() const { return ok_; }

 private:
  ByteSink& sink_;
  std::vector<char> bytes_;
  std::size_t used_ = 0;
  std::uint64_t flushed_ = 0;
  bool ok_ = true;
};

void put_binary(Buffer& buffer, const Facet& facet) {
  constexpr std::size_t facet_bytes = 50;
  char* const to = buffer.claim(facet_bytes);
  const Point normal = normal_of(facet);
  std::memcpy(to, normal.data(), sizeof normal);
  std::memcpy(to + sizeof normal, facet.data(), sizeof facet);
  std::memset(to + sizeof normal + sizeof facet, 0, 2);
  buffer.advance(facet_bytes);
}

void put_point(Buffer& buffer, std::string_view keyword, const Point& point) {
  buffer.put(keyword);
  for (const float c : point) {
    constexpr std::size_t longest = 24;
    char* const to = buffer.claim(longest);
    *to = ' ';
    buffer.advance(static_cast<std::size_t>(std::to_chars(to + 1, to + longest, c).ptr - to));
  }
  buffer.put("\n");
}

void put_ascii(Buffer& buffer, const Facet& facet) {
  put_point(buffer, "facet normal", normal_of(facet));
  buffer.put("outer loop\n");
  for (const Point& corner : facet) put_point(buffer, "vertex", corner);
  buffer.put("endloop\nendfacet\n");
}

template <typename Put>
void visit_facets(const TriangleStream& triangles, StlCounts& counts, Put put) {
  triangles([&](std::span<const Triangle> block) {
    for (const Triangle& triangle : block) {
      const Facet facet = to_facet(triangle);
      if (is_folded(facet)) {
        ++counts.left_out;
      } else {
        ++counts.triangles;
        put(facet);
      }
    }
  });
}

void put_header(Buffer& buffer, std::uint32_t count) {
  std::array<char, 84> header{};
  constexpr std::string_view title = "binary STL in millimetres, written by meso";
  std::memcpy(header.data(), title.data(), title.size());
  std::memcpy(header.data() + 80, &count, sizeof count);
  buffer.put({header.data(), header.size()});
}

}  // namespace

StlCounts write_stl(const TriangleStream& triangles, StlFormat format, ByteSink& sink) {
  Buffer buffer(sink);
  StlCounts counts;
  if (format == StlFormat::ascii) {
    buffer.put("solid meso\n");
    visit_facets(triangles, counts, [&](const Facet& facet) {
      if (buffer.ok()) put_ascii(buffer, facet);
    });
    buffer.put("endsolid meso\n");
  } else {
    visit_facets(triangles, counts, [](const Facet&) {});
    if (counts.triangles > std::numeric_limits<std::uint32_t>::max()) {
      counts.complete = false;
      return counts;
    }
    put_header(buffer, static_cast<std::uint32_t>(counts.triangles));
    counts = {};
    visit_facets(triangles, counts, [&](const Facet& facet) {
      if (buffer.ok()) put_binary(buffer, facet);
    });
  }
  buffer.flush();
  counts.bytes = buffer.total();
  counts.complete = buffer.ok();
  return counts;
}

}  // namespace meso
