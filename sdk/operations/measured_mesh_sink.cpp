// SPDX-License-Identifier: Apache-2.0
#include "measured_mesh_sink.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

namespace meso::operations {
namespace {

/// Before the bytes of the sink behind, and what was measured of them; consecutive blocks may arrive joined.
struct PointsFrame {
  std::uint64_t bytes = 0, points = 0;
};
struct TrianglesFrame {
  std::uint64_t bytes = 0, triangles = 0;
  double volume = 0, area = 0;
  std::uint64_t edge_balance = 0;
};

struct MeasuredTriangle {
  IndexTriangle corners{};
  double volume = 0;
};

/// Room for a frame, to be filled once what follows is there.
template <class Frame>
std::size_t reserve_frame(ByteBuffer& out) {
  const std::size_t at = out.size();
  (void)out.claim(sizeof(Frame));
  out.advance(sizeof(Frame));
  return at;
}
template <class Frame>
void put_frame(ByteBuffer& out, std::size_t at, const Frame& frame) {
  std::memcpy(const_cast<char*>(out.view().data()) + at, &frame, sizeof frame);
}
template <class T>
T take(std::string_view& bytes) {
  T value;
  std::memcpy(&value, bytes.data(), sizeof value);
  bytes.remove_prefix(sizeof value);
  return value;
}

/// Random-looking, the same for both directions (Steele, Lea and Flood's SplitMix64).
std::uint64_t edge_hash(std::uint32_t a, std::uint32_t b) {
  std::uint64_t h = (std::uint64_t{a} << 32 | b) + 0x9E3779B97F4A7C15;
  h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9;
  h = (h ^ (h >> 27)) * 0x94D049BB133111EB;
  return h ^ (h >> 31);
}

}  // namespace

template <class Real>
void MeasuredMeshSink<Real>::encode_points(std::span<const Vec3> block, ByteBuffer& out) const {
  const std::size_t at = reserve_frame<PointsFrame>(out);
  into_.encode_points(block, out);
  put_frame(out, at, PointsFrame{.bytes = out.size() - at - sizeof(PointsFrame), .points = block.size()});
  char* to = out.claim(block.size() * sizeof(Point));
  for (const Vec3& p : block) {
    const Point rounded{static_cast<Real>(p.x), static_cast<Real>(p.y), static_cast<Real>(p.z)};
    std::memcpy(to, &rounded, sizeof rounded);
    to += sizeof rounded;
  }
  out.advance(block.size() * sizeof(Point));
}

template <class Real>
bool MeasuredMeshSink<Real>::write_points(std::string_view bytes) {
  while (!bytes.empty()) {
    const auto frame = take<PointsFrame>(bytes);
    if (!into_.write_points(bytes.substr(0, frame.bytes))) return false;
    bytes.remove_prefix(frame.bytes);
    const std::size_t first = points_.size();
    points_.resize(first + frame.points);
    std::memcpy(points_.data() + first, bytes.data(), frame.points * sizeof(Point));
    bytes.remove_prefix(frame.points * sizeof(Point));
    for (std::size_t i = first; i < points_.size(); ++i)
      measures_.box.extend({points_[i][0], points_[i][1], points_[i][2]});
  }
  return true;
}

template <class Real>
bool MeasuredMeshSink<Real>::begin_triangles(std::uint64_t point_count) {
  parents_.resize(point_count);
  std::iota(parents_.begin(), parents_.end(), 0u);
  enclosed_.assign(point_count, 0);
  return into_.begin_triangles(point_count);
}

template <class Real>
void MeasuredMeshSink<Real>::encode_triangles(std::span<const IndexTriangle> block, ByteBuffer& out) const {
  const std::size_t at = reserve_frame<TrianglesFrame>(out);
  into_.encode_triangles(block, out);
  TrianglesFrame frame{.bytes = out.size() - at - sizeof frame, .triangles = block.size()};
  // Seen from a point of the mesh: far from the origin the terms would be large and cancel.
  const Vec3 eye = points_.empty() ? Vec3{} : point(0);
  char* to = out.claim(block.size() * sizeof(MeasuredTriangle));
  for (const IndexTriangle& t : block) {
    const Vec3 a = point(t[0]), b = point(t[1]), c = point(t[2]);
    const Vec3 twice = cross(b - a, c - a);
    const MeasuredTriangle measured{.corners = t, .volume = dot(a - eye, twice) / 6};
    frame.volume += measured.volume;
    frame.area += norm(twice) / 2;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = t[i], next = t[(i + 1) % 3];
      frame.edge_balance += from < next ? edge_hash(from, next) : 0 - edge_hash(next, from);
    }
    std::memcpy(to, &measured, sizeof measured);
    to += sizeof measured;
  }
  out.advance(block.size() * sizeof(MeasuredTriangle));
  put_frame(out, at, frame);
}

template <class Real>
bool MeasuredMeshSink<Real>::write_triangles(std::string_view bytes) {
  while (!bytes.empty()) {
    const auto frame = take<TrianglesFrame>(bytes);
    if (!into_.write_triangles(bytes.substr(0, frame.bytes))) return false;
    bytes.remove_prefix(frame.bytes);
    measures_.volume += frame.volume;
    measures_.area += frame.area;
    measures_.triangles += frame.triangles;
    edge_balance_ += frame.edge_balance;
    for (std::uint64_t i = 0; i < frame.triangles; ++i) {
      const auto t = take<MeasuredTriangle>(bytes);
      enclosed_[join(t.corners)] += t.volume;
    }
  }
  return true;
}

/// The three corners' common root.
template <class Real>
std::uint32_t MeasuredMeshSink<Real>::join(const IndexTriangle& t) {
  std::uint32_t top = root(t[0]);
  // The smaller number stays root: paths stay short along the order in which points are made.
  for (const std::uint32_t corner : {t[1], t[2]}) {
    const std::uint32_t other = root(corner);
    if (other == top) continue;
    const std::uint32_t stays = std::min(top, other), goes = std::max(top, other);
    parents_[goes] = stays;
    enclosed_[stays] += enclosed_[goes];
    top = stays;
  }
  return top;
}

template <class Real>
std::uint32_t MeasuredMeshSink<Real>::root(std::uint32_t point) {
  while (parents_[point] != point) {
    parents_[point] = parents_[parents_[point]];  // path halving
    point = parents_[point];
  }
  return point;
}

template <class Real>
MeshMeasures MeasuredMeshSink<Real>::measures(double crumb) const {
  MeshMeasures out = measures_;
  out.points = points_.size();
  out.closed = edge_balance_ == 0;
  out.euler = static_cast<std::int64_t>(out.points) - static_cast<std::int64_t>(out.triangles / 2);
  for (std::uint32_t i = 0; i < parents_.size(); ++i) {
    if (parents_[i] != i) continue;
    ++(std::abs(enclosed_[i]) < crumb ? out.crumbs : enclosed_[i] > 0 ? out.components : out.cavities);
    if (std::abs(enclosed_[i]) >= crumb && enclosed_[i] < 0) out.cavity_volume -= enclosed_[i];
  }
  return out;
}

template class MeasuredMeshSink<float>;
template class MeasuredMeshSink<double>;

}  // namespace meso::operations
