// SPDX-License-Identifier: Apache-2.0
#include "text_writers.hpp"

#include <array>
#include <cstdio>
#include <string>

#include "number_lines.hpp"

namespace meso {
namespace {

// Fixed width, because the counts are known late: readers skip blanks.
std::string off_header(std::uint64_t points, std::uint64_t triangles) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "OFF\n%12llu %12llu 0\n", static_cast<unsigned long long>(points),
                static_cast<unsigned long long>(triangles));
  return text.data();
}

}  // namespace

template <class Real>
bool ObjWriter<Real>::begin() {
  return this->file_.write("# millimetres, written by meso\n");
}

template <class Real>
void ObjWriter<Real>::encode_points(std::span<const Vec3> block, ByteBuffer& out) const {
  put_points<Real>({"v ", " ", " ", "\n"}, block, out);
}

template <class Real>
void ObjWriter<Real>::encode_triangles(std::span<const IndexTriangle> block, ByteBuffer& out) const {
  for (const IndexTriangle& t : block)
    put_line({"f ", " ", " ", "\n"}, std::array{t[0] + 1, t[1] + 1, t[2] + 1}, out);  // from 1 on
}

template <class Real>
bool ObjWriter<Real>::finish(std::uint64_t) {
  return true;
}

template <class Real>
bool OffWriter<Real>::begin() {
  return this->file_.write(off_header(0, 0));
}

template <class Real>
void OffWriter<Real>::encode_points(std::span<const Vec3> block, ByteBuffer& out) const {
  put_points<Real>({"", " ", " ", "\n"}, block, out);
}

template <class Real>
void OffWriter<Real>::encode_triangles(std::span<const IndexTriangle> block, ByteBuffer& out) const {
  for (const IndexTriangle& t : block) put_line({"3 ", " ", " ", "\n"}, t, out);
}

template <class Real>
bool OffWriter<Real>::finish(std::uint64_t triangle_count) {
  return this->file_.write_at(0, off_header(this->points_, triangle_count));
}

template class ObjWriter<float>;
template class ObjWriter<double>;
template class OffWriter<float>;
template class OffWriter<double>;

}  // namespace meso
