// SPDX-License-Identifier: Apache-2.0
#include "measured_mesh_sink.hpp"

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

void MeasuredMeshSink::encode_points(std::span<const Vec3> block, ByteBuffer& out) const {
  const std::size_t at = reserve_frame<PointsFrame>(out);
  into_.encode_points(block, out);
  put_frame(out, at, PointsFrame{.bytes = out.size() - at - sizeof(PointsFrame), .points = block.size()});
  char* to = out.claim(block.size() * sizeof(points_[0]));
  for (const Vec3& p : block) {
    const std::array<float, 3> rounded{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    std::memcpy(to, &rounded, sizeof rounded);
    to += sizeof rounded;
  }
  out.advance(block.size() * sizeof(points_[0]));
}

bool MeasuredMeshSink::write_points(std::string_view bytes) {
  while (!bytes.empty()) {
    const auto frame = take<PointsFrame>(bytes);
    if (!into_.write_points(bytes.substr(0, frame.bytes))) return false;
    bytes.remove_prefix(frame.bytes);
    const std::size_t first = points_.size();
    points_.resize(first + frame.points);
    std::memcpy(points_.data() + first, bytes.data(), frame.points * sizeof(points_[0]));
    bytes.remove_prefix(frame.points * sizeof(points_[0]));
    for (std::size_t i = first; i < points_.size(); ++i)
      measures_.box.extend({points_[i][0], points_[i][1], points_[i][2]});
  }
  return true;
}

bool MeasuredMeshSink::begin_triangles(std::uint64_t point_count) {
  parents_.resize(point_count);
  std::iota(parents_.begin(), parents_.end(), 0u);
  return into_.begin_triangles(point_count);
}

void MeasuredMeshSink::encode_triangles(std::span<const IndexTriangle> block, ByteBuffer& out) const {
  const std::size_t at = reserve_frame<TrianglesFrame>(out);
  into_.encode_triangles(block, out);
  TrianglesFrame frame{.bytes = out.size() - at - sizeof frame, .triangles = block.size()};
  const auto point = [&](std::uint32_t i) { return Vec3{points_[i][0], points_[i][1], points_[i][2]}; };
  for (const IndexTriangle& t : block) {
    const Vec3 a = point(t[0]), b = point(t[1]), c = point(t[2]);
    const Vec3 twice = cross(b - a, c - a);
    frame.volume += dot(a, twice) / 6;
    frame.area += norm(twice) / 2;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = t[i], to = t[(i + 1) % 3];
      frame.edge_balance += from < to ? edge_hash(from, to) : 0 - edge_hash(to, from);
    }
  }
  put_frame(out, at, frame);
  out.append({reinterpret_cast<const char*>(block.data()), block.size_bytes()});
}

bool MeasuredMeshSink::write_triangles(std::string_view bytes) {
  while (!bytes.empty()) {
    const auto frame = take<TrianglesFrame>(bytes);
    if (!into_.write_triangles(bytes.substr(0, frame.bytes))) return false;
    bytes.remove_prefix(frame.bytes);
    measures_.volume += frame.volume;
    measures_.area += frame.area;
    measures_.triangles += frame.triangles;
    edge_balance_ += frame.edge_balance;
    for (std::uint64_t i = 0; i < frame.triangles; ++i) {
      const auto t = take<IndexTriangle>(bytes);
      const std::uint32_t a = root(t[0]);
      // The smaller number stays root: paths stay short along the order in which points are made.
      for (const std::uint32_t other : {root(t[1]), root(t[2])}) {
        const std::uint32_t top = root(a);
        if (other < top) parents_[top] = other;
        if (top < other) parents_[other] = top;
      }
    }
  }
  return true;
}

std::uint32_t MeasuredMeshSink::root(std::uint32_t point) {
  while (parents_[point] != point) {
    parents_[point] = parents_[parents_[point]];  // path halving
    point = parents_[point];
  }
  return point;
}

bool MeasuredMeshSink::finish(std::uint64_t triangle_count) { return into_.finish(triangle_count); }

MeshMeasures MeasuredMeshSink::measures() const {
  MeshMeasures out = measures_;
  out.points = points_.size();
  out.closed = edge_balance_ == 0;
  out.euler = static_cast<std::int64_t>(out.points) - static_cast<std::int64_t>(out.triangles / 2);
  for (std::uint32_t i = 0; i < parents_.size(); ++i) out.components += parents_[i] == i ? 1 : 0;
  return out;
}

}  // namespace meso::operations
