// SPDX-License-Identifier: Apache-2.0
#include "ply_writer.hpp"

#include <array>
#include <bit>
#include <cstring>
#include <string>

namespace meso {
namespace {

static_assert(std::endian::native == std::endian::little, "the file is little-endian");

// The counts stand before the data and are known after them, so the header has a fixed length, filled up by a comment.
constexpr std::size_t header_bytes = 256;

std::string ply_header(std::string_view real, std::uint64_t points, std::uint64_t triangles) {
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(points);
  for (const char axis : {'x', 'y', 'z'}) ((text += "\nproperty ") += real) += std::string(" ") + axis;
  text += "\nelement face " + std::to_string(triangles) + "\nproperty list uchar int vertex_indices\ncomment ";
  constexpr std::string_view end = "\nend_header\n";
  text.resize(header_bytes - end.size(), '.');
  return text += end;
}

}  // namespace

template <class Real>
bool PlyWriter<Real>::begin() {
  return file_.write(std::string(header_bytes, ' '));
}

template <class Real>
void PlyWriter<Real>::encode_points(std::span<const Vec3> block, ByteBuffer& out) const {
  using Point = std::array<Real, 3>;
  char* to = out.claim(block.size() * sizeof(Point));
  for (const Vec3& p : block) {
    const Point point{static_cast<Real>(p.x), static_cast<Real>(p.y), static_cast<Real>(p.z)};
    std::memcpy(to, &point, sizeof point);
    to += sizeof point;
  }
  out.advance(block.size() * sizeof(Point));
}

template <class Real>
void PlyWriter<Real>::encode_triangles(std::span<const IndexTriangle> block, ByteBuffer& out) const {
  constexpr std::size_t record = 1 + sizeof(IndexTriangle);
  char* to = out.claim(block.size() * record);
  for (const IndexTriangle& t : block) {
    *to = 3;
    std::memcpy(to + 1, t.data(), sizeof t);
    to += record;
  }
  out.advance(block.size() * record);
}

template <class Real>
bool PlyWriter<Real>::finish(std::uint64_t triangle_count) {
  return file_.write_at(0, ply_header(std::is_same_v<Real, float> ? "float" : "double", points_, triangle_count));
}

template class PlyWriter<float>;
template class PlyWriter<double>;

}  // namespace meso
