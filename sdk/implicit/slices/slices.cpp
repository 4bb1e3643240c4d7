// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/slices.hpp"

#include <algorithm>
#include <string>

#include "meso/implicit/sampled_row.hpp"
#include "meso/implicit/threads.hpp"

namespace meso::implicit {
namespace {

constexpr std::int32_t planes_at_a_time = 8;

/// A plane of samples within one layer of outside nodes, in which node (i, j) of the grid is (i + 1, j + 1).
class Plane {
 public:
  explicit Plane(const Grid& grid)
      : grid_(grid), nx_(grid.nodes[0] + 2), ny_(grid.nodes[1] + 2), inside_(size()), values_(size(), 1.0F) {}

  void sample(GridSampler& sampler, bool signs_only, std::int32_t k) {
    SampledRow row(grid_.nodes[0]);
    sampler.begin_slab(k, k + 1);
    for (std::int32_t j = 0; j < grid_.nodes[1]; ++j) {
      row.sample(sampler, j, k);
      for (std::int32_t i = 0; i < grid_.nodes[0]; ++i) {
        inside_[at(i + 1, j + 1)] = row.inside(i) ? 1 : 0;
        values_[at(i + 1, j + 1)] = row.value(i);
      }
    }
    if (signs_only) ask_values(sampler, k);
  }

  /// Every crossed edge is left by one segment, and reached by one.
  [[nodiscard]] Slice contours(double height) const;

 private:
  using Edge = std::uint64_t;  // 2 node + (0 along x, 1 along y), from that node on
  struct Segment {
    Edge from, to;
  };

  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_); }
  [[nodiscard]] std::size_t at(std::int32_t i, std::int32_t j) const {
    return static_cast<std::size_t>(i) + static_cast<std::size_t>(nx_) * static_cast<std::size_t>(j);
  }
  void ask_values(GridSampler& sampler, std::int32_t k);
  void cell(std::int32_t i, std::int32_t j, std::vector<Segment>& out) const;
  [[nodiscard]] std::array<double, 2> vertex(Edge edge) const;
  [[nodiscard]] double coordinate(std::size_t axis, std::int32_t padded) const {
    return grid_.coordinate(axis, std::clamp(padded - 1, 0, grid_.nodes[axis] - 1));
  }

  const Grid& grid_;
  std::int32_t nx_, ny_;
  std::vector<std::uint8_t> inside_;
  std::vector<float> values_;
};

/// Fields whose values are dear give them only where they are asked for: at ends of crossed edges.
void Plane::ask_values(GridSampler& sampler, std::int32_t k) {
  std::vector<Vec3> points;
  std::vector<std::size_t> nodes;
  for (std::int32_t j = 1; j + 1 < ny_; ++j)
    for (std::int32_t i = 1; i + 1 < nx_; ++i) {
      const std::size_t n = at(i, j), row = static_cast<std::size_t>(nx_);
      const int around = inside_[n - 1] + inside_[n + 1] + inside_[n - row] + inside_[n + row];
      if (around == 4 * inside_[n]) continue;
      nodes.push_back(n);
      points.push_back(grid_.node(i - 1, j - 1, k));
    }
  std::vector<double> values(points.size());
  sampler.values_at(points, values.data());
  for (std::size_t i = 0; i < nodes.size(); ++i) values_[nodes[i]] = static_cast<float>(values[i]);
}

/// Corners counter-clockwise from the lower left; side s leads from corner s to the next.
void Plane::cell(std::int32_t i, std::int32_t j, std::vector<Segment>& out) const {
  const std::array<std::size_t, 4> corner{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
  unsigned code = 0;
  for (unsigned c = 0; c < 4; ++c) code |= static_cast<unsigned>(inside_[corner[c]]) << c;
  if (code == 0 || code == 15) return;
  const std::array<Edge, 4> side{2 * corner[0], 2 * corner[1] + 1, 2 * corner[3], 2 * corner[0] + 1};
  // With the solid on the left, a contour enters through a side that leads inward, and leaves through one that leads
  // outward.
  const auto inward = [&](unsigned s) { return (code >> s & 1) == 0 && (code >> (s + 1) % 4 & 1) != 0; };
  const auto outward = [&](unsigned s) { return (code >> s & 1) != 0 && (code >> (s + 1) % 4 & 1) == 0; };
  // Two inside corners across from each other are joined if the bilinear interpolant is negative at its saddle.
  bool joined = false;
  if (code == 5 || code == 10) {
    const unsigned a = code == 5 ? 0 : 1;
    const auto value = [&](unsigned c) { return static_cast<double>(values_[corner[c % 4]]); };
    joined = value(a) * value(a + 2) > value(a + 1) * value(a + 3);
  }
  for (unsigned s = 0; s < 4; ++s) {
    if (!outward(s)) continue;
    unsigned to = 0;
    if (code == 5 || code == 10) {
      to = joined ? (s + 1) % 4 : (s + 3) % 4;
    } else {
      while (!inward(to)) ++to;
    }
    out.push_back({side[s], side[to]});
  }
}

std::array<double, 2> Plane::vertex(Edge edge) const {
  const std::size_t from = edge / 2, to = from + (edge % 2 == 0 ? 1 : static_cast<std::size_t>(nx_));
  const auto position = [&](std::size_t node) {
    const auto i = static_cast<std::int32_t>(node % static_cast<std::size_t>(nx_)),
               j = static_cast<std::int32_t>(node / static_cast<std::size_t>(nx_));
    return std::array<double, 2>{coordinate(0, i), coordinate(1, j)};
  };
  const auto p = position(from), q = position(to);
  const double a = values_[from], b = values_[to];
  const double t = a / (a - b);
  // Samples without a value are outside; the contour is half-way to them.
  const double s = t >= 0 && t <= 1 ? t : 0.5;
  return {p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1])};
}

Slice Plane::contours(double height) const {
  std::vector<Segment> segments;
  for (std::int32_t j = 0; j + 1 < ny_; ++j)
    for (std::int32_t i = 0; i + 1 < nx_; ++i) cell(i, j, segments);
  std::sort(segments.begin(), segments.end(), [](const Segment& a, const Segment& b) { return a.from < b.from; });
  std::vector<bool> walked(segments.size());
  Slice slice{.height = height};
  for (std::size_t start = 0; start < segments.size(); ++start) {
    if (walked[start]) continue;
    auto& loop = slice.loops.emplace_back();
    for (std::size_t s = start; !walked[s];) {
      walked[s] = true;
      const auto p = vertex(segments[s].from);
      if (loop.empty() || loop.back() != p) loop.push_back(p);  // at the box's corners two edges meet in a point
      s = static_cast<std::size_t>(std::lower_bound(segments.begin(), segments.end(), segments[s].to,
                                                    [](const Segment& a, Edge e) { return a.from < e; }) -
                                   segments.begin());
    }
    while (loop.size() > 1 && loop.back() == loop.front()) loop.pop_back();
    if (loop.size() < 3) slice.loops.pop_back();
  }
  return slice;
}

}  // namespace

bool slice(const GridSource& source, std::int32_t count, const std::function<bool(const Slice&)>& take,
           const RunOptions& run, DiagnosticSink& diagnostics) {
  const Grid& grid = source.grid();
  const std::uint64_t bytes =
      (std::uint64_t(grid.nodes[0]) + 2) * (std::uint64_t(grid.nodes[1]) + 2) * 5 * planes_at_a_time;
  if (!fits_memory(grid, bytes, "planes of samples", run, diagnostics)) return false;
  Threads threads(run);
  std::vector<Slice> slices(planes_at_a_time);
  for (std::int32_t first = 0; first < count; first += planes_at_a_time) {
    const auto n = static_cast<std::size_t>(std::min(planes_at_a_time, count - first));
    const bool whole = threads.ranges("slices", n, 1, [&](std::size_t p, std::size_t) {
      const std::int32_t k = first + static_cast<std::int32_t>(p);
      Plane plane(grid);
      plane.sample(*source.sampler(), source.signs_only(), k);
      slices[p] = plane.contours(grid.coordinate(2, k));
    });
    if (!whole || !threads.go_on()) {
      threads.report_stop(diagnostics);
      return false;
    }
    for (std::size_t p = 0; p < n; ++p)
      if (!take(slices[p])) return false;
  }
  return true;
}

}  // namespace meso::implicit
