// SPDX-License-Identifier: Apache-2.0
#include "meso/export_stl/stl_facet.hpp"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

namespace meso {
namespace {

static_assert(std::endian::native == std::endian::little, "binary STL is little-endian");

// From the corners as written, so that reader and writer agree; zero where they are collinear.
StlPoint normal_of(const StlFacet& f) {
  const auto vec = [](const StlPoint& p) { return Vec3{p[0], p[1], p[2]}; };
  const Vec3 n = cross(vec(f[1]) - vec(f[0]), vec(f[2]) - vec(f[0]));
  const double length = norm(n);
  if (!(length > 0)) return {0, 0, 0};
  return to_stl_point(n / length);
}

void put_point(std::string_view keyword, const StlPoint& point, ByteBuffer& out) {
  constexpr std::size_t longest = 24;
  char* const begin = out.claim(keyword.size() + 3 * longest + 1);
  char* to = begin + keyword.copy(begin, keyword.size());
  for (const float c : point) {
    *to++ = ' ';
    to = std::to_chars(to, to + longest - 1, c).ptr;
  }
  *to++ = '\n';
  out.advance(static_cast<std::size_t>(to - begin));
}

}  // namespace

StlPoint to_stl_point(Vec3 p) {
  const auto real = [](double c) { return static_cast<float>(c) + 0.0F; };  // + 0: one zero, not two
  return {real(p.x), real(p.y), real(p.z)};
}

StlFacet to_stl_facet(const Triangle& t) { return {to_stl_point(t[0]), to_stl_point(t[1]), to_stl_point(t[2])}; }

void put_facet(const StlFacet& facet, StlFormat format, ByteBuffer& out) {
  const StlPoint normal = normal_of(facet);
  if (format == StlFormat::binary) {
    char* const to = out.claim(stl_facet_bytes);
    std::memcpy(to, normal.data(), sizeof normal);
    std::memcpy(to + sizeof normal, facet.data(), sizeof facet);
    std::memset(to + sizeof normal + sizeof facet, 0, 2);
    out.advance(stl_facet_bytes);
    return;
  }
  put_point("facet normal", normal, out);
  out.append("outer loop\n");
  for (const StlPoint& corner : facet) put_point("vertex", corner, out);
  out.append("endloop\nendfacet\n");
}

std::string stl_begin(StlFormat format, std::uint32_t count) {
  if (format == StlFormat::ascii) return "solid meso\n";
  std::string header = "binary STL in millimetres, written by meso";
  header.resize(stl_count_offset);
  header.append(reinterpret_cast<const char*>(&count), sizeof count);
  return header;
}

std::string stl_end(StlFormat format) { return format == StlFormat::ascii ? "endsolid meso\n" : ""; }

}  // namespace meso
