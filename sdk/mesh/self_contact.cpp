// SPDX-License-Identifier: Apache-2.0
#include "meso/mesh/self_contact.hpp"

#include <algorithm>
#include <cmath>
#include <compare>
#include <vector>

namespace meso {
namespace {

using Corners = Triangle;
using Cell = std::array<std::int64_t, 3>;

Box3 box_of(const Corners& t) {
  Box3 box;
  for (const Vec3& p : t) box.extend(p);
  return box;
}

/// Sign of the volume of the tetrahedron a b c d.
double orientation(Vec3 a, Vec3 b, Vec3 c, Vec3 d) { return dot(cross(b - a, c - a), d - a); }

/// Segment p q and triangle t in general position: p and q on different sides, and the line passes the triangle.
bool segment_meets(Vec3 p, Vec3 q, const Corners& t) {
  const double sp = orientation(t[0], t[1], t[2], p), sq = orientation(t[0], t[1], t[2], q);
  if (sp * sq > 0 || (sp == 0 && sq == 0)) return false;
  const double a = orientation(p, q, t[0], t[1]), b = orientation(p, q, t[1], t[2]), c = orientation(p, q, t[2], t[0]);
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

struct Point2 {
  double u, v;
};
double turn(Point2 a, Point2 b, Point2 c) { return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u); }

/// Triangles in one plane overlap unless an edge of either separates them.
bool coplanar_overlap(const Corners& s, const Corners& t) {
  const Vec3 n = cross(s[1] - s[0], s[2] - s[0]);
  const std::size_t drop =
      std::abs(n.x) > std::abs(n.y) ? (std::abs(n.x) > std::abs(n.z) ? 0 : 2) : (std::abs(n.y) > std::abs(n.z) ? 1 : 2);
  const auto flat = [drop](Vec3 p) { return Point2{p[(drop + 1) % 3], p[(drop + 2) % 3]}; };
  const auto separates = [&](const Corners& a, const Corners& b) {
    const double sense = turn(flat(a[0]), flat(a[1]), flat(a[2]));
    for (std::size_t i = 0; i < 3; ++i) {
      const bool outside = std::all_of(
          b.begin(), b.end(), [&](Vec3 p) { return sense * turn(flat(a[i]), flat(a[(i + 1) % 3]), flat(p)) < 0; });
      if (outside) return true;
    }
    return false;
  };
  return !separates(s, t) && !separates(t, s);
}

}  // namespace

bool triangles_meet(const Corners& s, const Corners& t) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (segment_meets(s[i], s[(i + 1) % 3], t) || segment_meets(t[i], t[(i + 1) % 3], s)) return true;
  }
  const bool coplanar = std::all_of(t.begin(), t.end(), [&](Vec3 p) { return orientation(s[0], s[1], s[2], p) == 0; });
  return coplanar && coplanar_overlap(s, t);
}

namespace {

/// The shortest way along the normal of t that takes s to one side of it.
double way_out(const Corners& s, const Corners& t) {
  const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
  const double length = norm(normal);
  if (length == 0) return 0;
  double above = 0, below = 0;
  for (const Vec3& p : s) {
    const double height = dot(p - t[0], normal) / length;
    above = std::max(above, height);
    below = std::max(below, -height);
  }
  return std::min(above, below);
}

/// A uniform grid whose buckets hold the triangles that can reach them.
class Grid {
 public:
  explicit Grid(const TriangleMesh& mesh) : mesh_(mesh) {
    double extent = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const Box3 b = box_of(corners(i));
      all_.extend(b.min);
      all_.extend(b.max);
      extent += std::max({b.max.x - b.min.x, b.max.y - b.min.y, b.max.z - b.min.z});
    }
    choose_cells(1.5 * extent / static_cast<double>(std::max<std::size_t>(1, mesh.triangles.size())));
    fill();
  }

  [[nodiscard]] Corners corners(std::size_t i) const {
    const auto& t = mesh_.triangles[i];
    return {mesh_.points[t[0]], mesh_.points[t[1]], mesh_.points[t[2]]};
  }
  [[nodiscard]] std::size_t buckets() const { return start_.size() - 1; }
  [[nodiscard]] std::pair<const std::uint32_t*, const std::uint32_t*> bucket(std::size_t b) const {
    return {entries_.data() + start_[b], entries_.data() + start_[b + 1]};
  }
  [[nodiscard]] std::size_t bucket_of(Vec3 p) const { return number(cell_of(p)); }

 private:
  void choose_cells(double size) {
    // At most four buckets a triangle, however unlike the triangles' sizes are.
    const auto most = 4.0 * static_cast<double>(mesh_.triangles.size()) + 64;
    const Vec3 span = all_.max - all_.min;
    size_ = std::max(size, 1e-12 * std::max({span.x, span.y, span.z, 1e-300}));
    const auto count = [&](std::size_t i) { return std::floor(span[i] / size_) + 1; };
    while (count(0) * count(1) * count(2) > most) size_ *= 1.26;
    for (std::size_t i = 0; i < 3; ++i) counts_[i] = static_cast<std::int64_t>(count(i));
  }
  [[nodiscard]] Cell cell_of(Vec3 p) const {
    Cell cell{};
    for (std::size_t i = 0; i < 3; ++i) {
      cell[i] = std::clamp<std::int64_t>(static_cast<std::int64_t>((p[i] - all_.min[i]) / size_), 0, counts_[i] - 1);
    }
    return cell;
  }
  [[nodiscard]] std::size_t number(const Cell& c) const {
    return static_cast<std::size_t>((c[0] * counts_[1] + c[1]) * counts_[2] + c[2]);
  }
  template <class Visit>
  void visit_cells(std::size_t triangle, Visit visit) const {
    const Box3 box = box_of(corners(triangle));
    const Cell low = cell_of(box.min), high = cell_of(box.max);
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) visit(number({x, y, z}));
      }
    }
  }
  void fill() {
    start_.assign(static_cast<std::size_t>(counts_[0] * counts_[1] * counts_[2]) + 1, 0);
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) visit_cells(i, [&](std::size_t b) { ++start_[b + 1]; });
    for (std::size_t b = 1; b < start_.size(); ++b) start_[b] += start_[b - 1];
    entries_.resize(start_.back());
    std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
      visit_cells(i, [&](std::size_t b) { entries_[next[b]++] = static_cast<std::uint32_t>(i); });
    }
  }

  const TriangleMesh& mesh_;
  Box3 all_;
  double size_ = 1;
  Cell counts_{1, 1, 1};
  std::vector<std::size_t> start_;
  std::vector<std::uint32_t> entries_;
};

using Indices = std::array<std::uint32_t, 3>;

std::ptrdiff_t count_shared(const Indices& a, const Indices& b) {
  return std::ranges::count_if(a, [&](std::uint32_t p) { return std::ranges::count(b, p) > 0; });
}

/// Of triangles that share one point: does the edge of `s` that is opposite to it pass through `t`?
bool opposite_edge_meets(const Indices& of_s, const Corners& s, const Indices& of_t, const Corners& t) {
  for (std::size_t i = 0; i < 3; ++i)
    if (std::ranges::count(of_t, of_s[i]) > 0) return segment_meets(s[(i + 1) % 3], s[(i + 2) % 3], t);
  return false;
}

/// visit(i, j, corner of their common box) for each pair, until it returns false.
template <class Visit>
void visit_pairs(const TriangleMesh& mesh, SharedPoint shared, Visit visit) {
  if (mesh.triangles.empty()) return;
  const Grid grid(mesh);
  for (std::size_t b = 0; b < grid.buckets(); ++b) {
    const auto [first, last] = grid.bucket(b);
    for (const std::uint32_t* i = first; i != last; ++i) {
      const Corners s = grid.corners(*i);
      const Box3 box = box_of(s);
      for (const std::uint32_t* j = i + 1; j != last; ++j) {
        const Indices &of_s = mesh.triangles[*i], &of_t = mesh.triangles[*j];
        const auto common = count_shared(of_s, of_t);
        if (common > (shared == SharedPoint::tested ? 1 : 0)) continue;
        const Corners t = grid.corners(*j);
        const Box3 other = box_of(t);
        if (!box.intersects(other)) continue;
        // A pair that meets in several buckets counts in the one that holds the low corner of the common box.
        const Vec3 corner{std::max(box.min.x, other.min.x), std::max(box.min.y, other.min.y),
                          std::max(box.min.z, other.min.z)};
        if (grid.bucket_of(corner) != b) continue;
        if (common == 0 ? !triangles_meet(s, t)
                        : !opposite_edge_meets(of_s, s, of_t, t) && !opposite_edge_meets(of_t, t, of_s, s))
          continue;
        if (!visit(*i, *j, s, t, corner)) return;
      }
    }
  }
}

}  // namespace

SelfContacts count_self_contacts(const TriangleMesh& mesh, std::span<const double> heights, std::uint64_t limit,
                                 SharedPoint shared) {
  SelfContacts out;
  visit_pairs(mesh, shared, [&](std::uint32_t i, std::uint32_t j, const Corners& s, const Corners& t, Vec3 corner) {
    const double depth = std::min(way_out(s, t), way_out(t, s));
    if (!out.place || depth > out.deepest_mm) {
      out.place = corner;
      out.deepest_mm = depth;
    }
    ++out.pairs;
    out.deep += heights.empty() || !(depth <= heights[i] + heights[j]);
    return out.deep < limit;
  });
  return out;
}

std::vector<std::array<std::uint32_t, 2>> deep_self_contacts(const TriangleMesh& mesh, std::span<const double> heights,
                                                             std::size_t limit) {
  std::vector<std::array<std::uint32_t, 2>> pairs;
  visit_pairs(mesh, SharedPoint::skipped,
              [&](std::uint32_t i, std::uint32_t j, const Corners& s, const Corners& t, Vec3) {
                if (!(std::min(way_out(s, t), way_out(t, s)) <= heights[i] + heights[j])) pairs.push_back({i, j});
                return pairs.size() < limit;
              });
  return pairs;
}

// Where a surface of curvature k turns by t between the middles of two triangles of altitudes g and h over their common
// segment, t = k (g + h) / 3; over an equilateral triangle of altitude h it rises by 2/9 k h^2, over others by less.
std::vector<double> chord_heights(const TriangleMesh& mesh) {
  constexpr double sharpest_turn = 1;
  std::vector<Vec3> normals;  // as long as the triangle has area, twice
  for (const auto& t : mesh.triangles)
    normals.push_back(cross(mesh.points[t[1]] - mesh.points[t[0]], mesh.points[t[2]] - mesh.points[t[0]]));
  struct Side {
    std::uint32_t a, b, triangle;
    auto operator<=>(const Side&) const = default;
  };
  std::vector<Side> sides;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(mesh.triangles[i][k], mesh.triangles[i][(k + 1) % 3]);
      sides.push_back({a, b, i});
    }
  std::sort(sides.begin(), sides.end());
  std::vector<double> heights(mesh.triangles.size());
  for (std::size_t n = 1; n < sides.size(); ++n) {
    const Side &s = sides[n - 1], &t = sides[n];
    if (s.a != t.a || s.b != t.b) continue;
    const double turn = std::atan2(norm(cross(normals[s.triangle], normals[t.triangle])),
                                   dot(normals[s.triangle], normals[t.triangle]));
    const double length = norm(mesh.points[s.b] - mesh.points[s.a]);
    if (turn > sharpest_turn || length == 0) continue;
    const double g = norm(normals[s.triangle]) / length, h = norm(normals[t.triangle]) / length;
    if (g + h == 0) continue;
    heights[s.triangle] = std::max(heights[s.triangle], 2 * turn * g * g / (3 * (g + h)));
    heights[t.triangle] = std::max(heights[t.triangle], 2 * turn * h * h / (3 * (g + h)));
  }
  return heights;
}

}  // namespace meso
