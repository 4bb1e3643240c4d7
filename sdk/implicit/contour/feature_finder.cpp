// SPDX-License-Identifier: Apache-2.0
#include "feature_finder.hpp"

#include <algorithm>
#include <cmath>

namespace meso::implicit {
namespace {

constexpr double candidate_cosine = 0.9, sharp_cosine = 0.95;
constexpr std::size_t batch = 1024;

/// Tells one sheet from two, and stays far from rounding.
constexpr double slope_step = 1e-5;

/// The least cosine between two of the normals; NaN if there is no telling.
template <class Normal>
double spread(std::size_t count, Normal normal) {
  double least = 1;
  for (std::size_t a = 1; a < count; ++a)
    for (std::size_t b = 0; b < a; ++b) {
      const double cosine = dot(normal(a), normal(b));
      if (std::isnan(cosine)) return cosine;
      least = std::min(least, cosine);
    }
  return least;
}

}  // namespace

// Tangent planes at points near the surface. One-sided differences: so close to an edge that both sides of a point are
// not the same sheet, few points lie.
void FeatureFinder::take_planes(std::span<const Vec3> at, double step, GridSampler& sampler,
                                const std::function<bool()>& go_on, std::vector<Plane>& planes) {
  planes.resize(at.size());
  const Vec3 steps{step * grid_.spacing(0), step * grid_.spacing(1), step * grid_.spacing(2)};
  for (std::size_t begin = 0; begin < at.size() && go_on(); begin += batch) {
    const std::size_t count = std::min(batch, at.size() - begin);
    asked_.resize(4 * count);
    values_.resize(4 * count);
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t axis = 0; axis < 4; ++axis) {
        Vec3& p = asked_[axis * count + i] = at[begin + i];
        if (axis < 3) p[axis] += steps[axis];
      }
    sampler.values_at(asked_, values_.data());
    for (std::size_t i = 0; i < count; ++i) {
      const double value = values_[3 * count + i];
      Vec3 slope;
      for (std::size_t axis = 0; axis < 3; ++axis)
        slope[axis] = (values_[axis * count + i] - value) / (asked_[axis * count + i][axis] - at[begin + i][axis]);
      const double length = norm(slope);
      planes[begin + i] = {at[begin + i], slope / length, value / length};
    }
  }
}

const std::vector<FeatureFinder::Found>& FeatureFinder::find(BrickCrossings& crossings, std::span<const Vec3> points,
                                                             std::size_t first, std::size_t last,
                                                             std::span<const JoinedCell> joined, GridSampler& sampler,
                                                             const std::function<bool()>& go_on) {
  candidates_.clear();
  found_.clear();
  take_planes(points, slope_step, sampler, go_on, planes_);
  for (std::size_t k = std::max<std::size_t>(first, 1); k < std::min(last, layout_.nz) && go_on(); ++k)
    for (std::size_t j = 1; j < layout_.ny; ++j) {
      const auto row = static_cast<std::uint32_t>((k - first) * (layout_.ny + 1) + j);
      while (!joined.empty() && joined.front().row < row) joined = joined.subspan(1);
      std::size_t count = 0;
      while (count < joined.size() && joined[count].row == row) ++count;
      look_at_row(crossings, points, j, k, row, joined.first(count));
    }
  for (const double share : {0.3, 0.05, 0.008, 0.0016}) approach(points, share, sampler, go_on);
  if (!go_on()) return found_;
  // Where the rounds do not settle, the field has more folds than there are samples to tell.
  std::erase_if(candidates_, [&](const Candidate& c) {
    return !c.sharp || !within_reach(c) || std::max(c.moved, c.off) > 1e-3 * grid_.spacing(0);
  });
  reject_turning(points, first, last);
  keep_borders(points, first, last);
  for (const Candidate& c : candidates_) {
    Vec3 position = c.position;
    for (std::size_t axis = 0; axis < 3; ++axis)
      position[axis] = std::clamp(position[axis], grid_.box.min[axis], grid_.box.max[axis]);
    found_.push_back({c.feature, position});
  }
  return found_;
}

void FeatureFinder::look_at_row(BrickCrossings& crossings, std::span<const Vec3> points, std::size_t j, std::size_t k,
                                std::uint32_t row, std::span<const JoinedCell> joined) {
  const std::uint64_t *const a = crossings.signs(j - 1, k - 1), *const b = crossings.signs(j, k - 1),
                             *const c = crossings.signs(j - 1, k), *const d = crossings.signs(j, k);
  cells_.clear();
  for (std::size_t w = 0; w < layout_.words; ++w) {
    const auto crossed = [&](const std::uint64_t* p) { return p[w] ^ moved_up(p, w); };
    const std::uint64_t across = (a[w] ^ b[w]) | (a[w] ^ c[w]) | (a[w] ^ d[w]);
    const std::uint64_t across_before =
        (moved_up(a, w) ^ moved_up(b, w)) | (moved_up(a, w) ^ moved_up(c, w)) | (moved_up(a, w) ^ moved_up(d, w));
    for_each_bit(crossed(a) | crossed(b) | crossed(c) | crossed(d) | across | across_before, w, [&](std::size_t cell) {
      if (cell > 0 && cell < layout_.nx) cells_.push_back(static_cast<std::uint16_t>(cell));
    });
  }
  if (cells_.empty()) return;
  crossings.enter_cells(j, k);
  for (const std::uint16_t cell : cells_) {
    const unsigned inside =
        two_signs(a, cell) | two_signs(b, cell) << 2 | two_signs(c, cell) << 4 | two_signs(d, cell) << 6;
    unsigned faces = 0;
    while (!joined.empty() && joined.front().cell < cell) joined = joined.subspan(1);
    if (!joined.empty() && joined.front().cell == cell) faces = joined.front().joined;
    const CellLoops& loops = table_.loops(inside, faces);
    for (std::size_t l = 0; l < loops.count; ++l)
      if (!loops.loops[l].has_centre) look_at_loop(loops.loops[l], crossings, points, row, cell);
  }
}

void FeatureFinder::look_at_loop(const CellLoop& loop, const BrickCrossings& crossings, std::span<const Vec3> points,
                                 std::uint32_t row, std::size_t cell) {
  Candidate c{.size = loop.size};
  for (std::size_t n = 0; n < loop.size; ++n)
    c.points[n] = static_cast<std::uint32_t>(crossings.point_of_edge(cell, loop.edges[n]));
  const auto normal = [&](std::size_t n) { return planes_[c.points[n]].normal; };
  if (!(spread(c.size, normal) < candidate_cosine)) return;
  c.feature = {.row = row, .cell = static_cast<std::uint16_t>(cell)};
  std::array<Plane, 12> planes;
  for (std::size_t n = 0; n < c.size; ++n) {
    const std::uint8_t edge = loop.edges[n], next = loop.edges[(n + 1) % loop.size];
    c.feature.edges |= static_cast<std::uint16_t>(1U << edge);
    c.edges[n] = edge;
    const std::uint8_t face = c.side_faces[n] = table_.common_face(edge, next);
    if (dot(normal(n), normal((n + 1) % loop.size)) < candidate_cosine)
      c.feature.faces |= static_cast<std::uint8_t>(1U << face);
    c.middle += points[c.points[n]] / loop.size;
    planes[n] = planes_[c.points[n]];
  }
  c.position = nearest_to_planes({planes.data(), c.size}, c.middle, 0.02);
  candidates_.push_back(c);
}

// One round: tangent planes where the way from the vertex to each crossing has gone its `share`.
void FeatureFinder::approach(std::span<const Vec3> points, double share, GridSampler& sampler,
                             const std::function<bool()>& go_on) {
  near_.clear();
  for (const Candidate& c : candidates_)
    for (std::size_t n = 0; c.sharp && n < c.size; ++n)
      near_.push_back(c.position + share * (points[c.points[n]] - c.position));
  take_planes(near_, slope_step * share, sampler, go_on, near_planes_);
  std::size_t next = 0;
  for (Candidate& c : candidates_) {
    if (!c.sharp) continue;
    const std::span<const Plane> planes(near_planes_.data() + next, c.size);
    next += c.size;
    c.sharp = spread(c.size, [&](std::size_t n) { return planes[n].normal; }) < sharp_cosine && within_reach(c);
    const Vec3 before = c.position;
    c.position = nearest_to_planes(planes, before, 0.005);
    c.moved = norm(c.position - before);
    c.off = 0;
    for (const Plane& plane : planes)
      c.off = std::max(c.off, std::fabs(dot(plane.normal, c.position - plane.at) + plane.value));
  }
}

/// At most a cell away from its own, and in the box but for rounding; NaN is nowhere.
bool FeatureFinder::within_reach(const Candidate& c) const {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double h = grid_.spacing(axis), x = c.position[axis];
    if (!(std::fabs(x - c.middle[axis]) <= 1.5 * h && x >= grid_.box.min[axis] - 1e-3 * h &&
          x <= grid_.box.max[axis] + 1e-3 * h))
      return false;
  }
  return true;
}

}  // namespace meso::implicit
