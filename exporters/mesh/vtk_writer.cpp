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

template <class Real>
std::string points_header(std::uint64_t points) {
  return "# vtk DataFile Version 3.0\nsurface in millimetres, written by meso\nBINARY\nDATASET POLYDATA\nPOINTS " +
         wide(points) + (sizeof(Real) == 4 ? " float\n" : " double\n");
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
char* put_big_endian(char* to, float value) { return put_big_endian(to, std::bit_cast<std::uint32_t>(value)); }
char* put_big_endian(char* to, double value) {
  const std::uint64_t bits = __builtin_bswap64(std::bit_cast<std::uint64_t>(value));
  std::memcpy(to, &bits, sizeof bits);
  return to + sizeof bits;
}

}  // namespace

template <class Real>
bool VtkWriter<Real>::begin() {
  return this->file_.write(points_header<Real>(0));
}

template <class Real>
void VtkWriter<Real>::encode_points(std::span<const Vec3> block, ByteBuffer& out) const {
  char* to = out.claim(3 * sizeof(Real) * block.size());
  for (const Vec3& p : block)
    for (std::size_t i = 0; i < 3; ++i) to = put_big_endian(to, static_cast<Real>(p[i]));
  out.advance(3 * sizeof(Real) * block.size());
}

template <class Real>
bool VtkWriter<Real>::begin_triangles(std::uint64_t point_count) {
  this->points_ = point_count;
  polygons_at_ = points_header<Real>(0).size() + 3 * sizeof(Real) * this->points_;
  return this->file_.write(polygons_header(0));
}

template <class Real>
void VtkWriter<Real>::encode_triangles(std::span<const IndexTriangle> block, ByteBuffer& out) const {
  char* to = out.claim(16 * block.size());
  for (const IndexTriangle& t : block) {
    to = put_big_endian(to, std::uint32_t{3});
    for (const std::uint32_t corner : t) to = put_big_endian(to, corner);
  }
  out.advance(16 * block.size());
}

template <class Real>
bool VtkWriter<Real>::finish(std::uint64_t triangle_count) {
  return this->file_.write("\n") && this->file_.write_at(0, points_header<Real>(this->points_)) &&
         this->file_.write_at(polygons_at_, polygons_header(triangle_count));
}

template class VtkWriter<float>;
template class VtkWriter<double>;

}  // namespace meso
