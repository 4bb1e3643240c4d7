// SPDX-License-Identifier: Apache-2.0
#include "row_signs.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "exact_sign.hpp"

namespace meso::implicit {
namespace {

struct Crossing {
  std::uint64_t row;
  std::int32_t node;  ///< the first one beyond
  std::int32_t change;
};

struct Found {
  std::vector<Crossing> crossings;
  std::vector<RowSigns::Touch> touches;
};

/// Meets one triangle with the rows of a grid.
class TriangleRows {
 public:
  TriangleRows(const Triangle& t, const GridTicks& ticks, Found& found) : t_(t), ticks_(ticks), found_(found) {}

  void find() {
    const auto [j0, j1] = range(ticks_.y, 1);
    if (j0 == j1) return;
    const auto [k0, k1] = range(ticks_.z, 2);
    if (k0 == k1) return;
    const auto [i0, i1] = range(ticks_.x, 0);
    first_ = i0;
    last_ = i1;
    normal_ = cross(t_[1] - t_[0], t_[2] - t_[0]);
    for (std::int32_t k = k0; k < k1; ++k) {
      for (std::int32_t j = j0; j < j1; ++j) meet(j, k);
    }
  }

 private:
  struct Range {
    std::int32_t first, last;
  };
  [[nodiscard]] Range range(const Ticks& ticks, std::size_t axis) const {
    const auto [low, high] = std::minmax({t_[0][axis], t_[1][axis], t_[2][axis]});
    return {ticks.at_or_after(low), ticks.after(high)};
  }

  void meet(std::int32_t j, std::int32_t k) {
    const double y = ticks_.y[j], z = ticks_.z[k];
    const RayView view = view_along_x(t_, y, z);
    bool may_touch = view.touches;
    const auto row = std::uint64_t{ticks_.row(j, k)};
    if (view.crossing != 0) {
      // Rounded guess first, then exactly.
      const double x = t_[0].x - ((y - t_[0].y) * normal_.y + (z - t_[0].z) * normal_.z) / normal_.x;
      std::int32_t node = std::isfinite(x) ? std::clamp(ticks_.x.at_or_after(x), first_, last_) : first_;
      const auto is_beyond = [&](std::int32_t i) {
        const int side = side_sign(t_, {ticks_.x[i], y, z});
        if (side == 0) may_touch = true;
        return side * view.crossing > 0;
      };
      while (node > first_ && is_beyond(node - 1)) --node;
      while (node < last_ && !is_beyond(node)) ++node;
      if (node < ticks_.x.size()) found_.crossings.push_back({row, node, -view.crossing});
    }
    if (!may_touch) return;
    for (std::int32_t i = first_; i < last_; ++i) {
      if (is_on(t_, {ticks_.x[i], y, z})) found_.touches.push_back({row, i});
    }
  }

  const Triangle& t_;
  const GridTicks& ticks_;
  Found& found_;
  std::int32_t first_ = 0, last_ = 0;  // nodes within the triangle's x; those beyond are beyond it for sure
  Vec3 normal_;
};

/// Sums what happens at each node, in place; returns how many changes are left.
std::size_t accumulate(std::span<RowSigns::Change> row) {
  std::sort(row.begin(), row.end(), [](const auto& a, const auto& b) { return a.node < b.node; });
  std::size_t kept = 0;
  std::int32_t winding = 0;
  for (std::size_t i = 0; i < row.size();) {
    const std::int32_t node = row[i].node, before = winding;
    for (; i < row.size() && row[i].node == node; ++i) winding += row[i].winding;
    if (winding != before) row[kept++] = {node, winding};
  }
  return kept;
}

}  // namespace

Ticks::Ticks(std::vector<double> values) : values_(std::move(values)) {
  const double length = values_.back() - values_.front();
  if (length > 0) per_unit_ = (size() - 1) / length;
}

std::int32_t Ticks::near(double x) const {
  return static_cast<std::int32_t>(std::clamp((x - values_[0]) * per_unit_, 0.0, double(size())));
}
std::int32_t Ticks::at_or_after(double x) const {
  std::int32_t i = near(x);
  while (i > 0 && (*this)[i - 1] >= x) --i;
  while (i < size() && (*this)[i] < x) ++i;
  return i;
}
std::int32_t Ticks::after(double x) const {
  std::int32_t i = near(x);
  while (i > 0 && (*this)[i - 1] > x) --i;
  while (i < size() && (*this)[i] <= x) ++i;
  return i;
}

RowSigns::RowSigns(std::span<const Triangle> triangles, const GridTicks& ticks, StopPoll& stop) {
  constexpr std::size_t block = 1 << 14;
  std::vector<Found> found((triangles.size() + block - 1) / block);
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t b) {
    if (stop()) return;
    for (const Triangle& t : triangles.subspan(b * block, std::min(block, triangles.size() - b * block)))
      TriangleRows(t, ticks, found[b]).find();
  });

  if (stop()) return;
  start_.assign(ticks.rows() + 2, 0);
  for (const Found& f : found) {
    for (const Crossing& c : f.crossings) ++start_[c.row + 2];
    touches_.insert(touches_.end(), f.touches.begin(), f.touches.end());
  }
  for (std::size_t r = 2; r < start_.size(); ++r) start_[r] += start_[r - 1];
  changes_.resize(start_.back());
  for (const Found& f : found) {
    for (const Crossing& c : f.crossings) changes_[start_[c.row + 1]++] = {c.node, c.change};
  }
  start_.pop_back();  // start_[r + 1] has become the end of row r

  std::size_t kept = 0, begin = 0;
  for (std::size_t r = 0; r < ticks.rows(); ++r) {
    const std::size_t end = start_[r + 1];
    const std::size_t count = accumulate(std::span(changes_).subspan(begin, end - begin));
    std::copy_n(changes_.begin() + static_cast<std::ptrdiff_t>(begin), count,
                changes_.begin() + static_cast<std::ptrdiff_t>(kept));
    start_[r] = kept;
    kept += count;
    begin = end;
  }
  start_[ticks.rows()] = kept;
  changes_.resize(kept);
  std::sort(touches_.begin(), touches_.end());
  touches_.erase(std::unique(touches_.begin(), touches_.end()), touches_.end());
}

std::span<const RowSigns::Touch> RowSigns::touches(std::size_t row) const {
  if (touches_.empty()) return {};
  const auto first = std::lower_bound(touches_.begin(), touches_.end(), Touch{row, -1});
  const auto last = std::find_if(first, touches_.end(), [row](const Touch& t) { return t.row != row; });
  return {first, last};
}

void RowSigns::keep_touches(std::span<const char> marks) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < marks.size(); ++t)
    if (marks[t] != 0) touches_[kept++] = touches_[t];
  touches_.resize(kept);
}

int RowSigns::sign(std::size_t row, std::int32_t node) const {
  if (!touches_.empty() && std::binary_search(touches_.begin(), touches_.end(), Touch{row, node})) return 0;
  const std::span<const Change> row_changes = changes(row);
  const auto next = std::upper_bound(row_changes.begin(), row_changes.end(), node,
                                     [](std::int32_t n, const Change& c) { return n < c.node; });
  return next == row_changes.begin() || (next - 1)->winding == 0 ? 1 : -1;
}

}  // namespace meso::implicit
