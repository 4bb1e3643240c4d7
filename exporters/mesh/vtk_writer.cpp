// SPDX-License-Identifier: Apache-2.0
#include "vtk_writer.hpp"

#include <array>
#include <bit>
#include <cstdio>
#include <cstring>
#include <string>

namespace meso {
namespace {

// Counts are known late: numbers of fixed width, led by blanks that readers skip.
std::string wide(std::uint64_t n) {
  std::array<char, 24> text{};
  std::snprintf(text.data(), text.size(), "%12llu", static_cast<unsigned long long>(n));
  return text.data();
}

std::string points_header(std::uint64_t points) {
  return "# vtk DataFile Version 3.0\nsurface in millimetres, written by meso\nBINARY\nDATASET POLYDATA\nPOINTS " +
         wide(points) + " float\n";
}

// A polygon is its number of corners and their indices: four numbers a triangle.
std::string polygons_header(std::uint64_t triangles) {
  return "\nPOLYGONS " + wide(triangles) + " " + wide(4 * triangles) + "\n";
}

char* put_big_endian(char* to, std::uint32_t bits) {
  static_assert(std::endian::native == std::endian::little);
  bits = __builtin_bswap32(bits);
  std::memcpy(to, &bits, sizeof bits);
  return to + sizeof bits;
}

}  // namespace

bool VtkWriter::begin() { return file_.write(points_header(0)); }

void VtkWriter::encode_points(std::span<const Vec3> block, ByteBuffer& out) const {
  char* to = out.claim(12 * block.size());
  for (const Vec3& p : block)
    for (std::size_t i = 0; i < 3; ++i) to = put_big_endian(to, std::bit_cast<std::uint32_t>(static_cast<float>(p[i])));
  out.advance(12 * block.size());
}

bool VtkWriter::begin_triangles(std::uint64_t point_count) {
  points_ = point_count;
  polygons_at_ = points_header(0).size() + 12 * points_;
  return file_.write(polygons_header(0));
}

void VtkWriter::encode_triangles(std::span<const IndexTriangle> block, ByteBuffer& out) const {
  char* to = out.claim(16 * block.size());
  for (const IndexTriangle& t : block) {
    to = put_big_endian(to, 3);
    for (const std::uint32_t corner : t) to = put_big_endian(to, corner);
  }
  out.advance(16 * block.size());
}

bool VtkWriter::finish(std::uint64_t triangle_count) {
  return file_.write("\n") && file_.write_at(0, points_header(points_)) &&
         file_.write_at(polygons_at_, polygons_header(triangle_count));
}

}  // namespace meso
