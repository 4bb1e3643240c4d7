// SPDX-License-Identifier: Apache-2.0
// A kd-tree (Bentley 1975) whose leaves hold their points side by side: a question in a place of its own costs a few
// cache lines, not one for every point that is looked at.
#include "meso/fields/point_search.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace meso::fields {
namespace {

constexpr std::size_t leaf_points = 8;
constexpr std::size_t poll_points = 1 << 15;  // sorting fewer takes a few milliseconds
/// Lower bounds of squared distances are sums of rounded terms: what is nearer than this is never left out.
constexpr double bound_slack = 1 + 1e-12;

struct Entry {
  Vec3 place;
  std::uint32_t number = 0;
};

/// Children stand at 2 i + 1 and 2 i + 2; `below` ends the lower child.
struct Split {
  double at = 0;
  std::uint32_t axis = 0;
};

/// The nearest one, by distance and then by number, so that the tree's order decides nothing.
struct NearestOne {
  double squared = HUGE_VAL;
  std::uint32_t number = std::numeric_limits<std::uint32_t>::max();

  [[nodiscard]] double worst() const { return squared; }
  void add(double distance, std::uint32_t n) {
    if (distance > squared || (distance == squared && n > number)) return;
    squared = distance;
    number = n;
  }
};

/// The `size` nearest in that order.
class NearestMany {
 public:
  explicit NearestMany(std::size_t size) : size_(size) {}

  [[nodiscard]] std::size_t size() const { return found_; }
  [[nodiscard]] double worst() const { return found_ == size_ ? squared_[found_ - 1] : HUGE_VAL; }
  void add(double distance, std::uint32_t number) {
    std::size_t place = found_;
    if (found_ == size_) {
      if (!before(distance, number, found_ - 1)) return;
      --place;
    } else {
      ++found_;
    }
    for (; place > 0 && before(distance, number, place - 1); --place) {
      squared_[place] = squared_[place - 1];
      number_[place] = number_[place - 1];
    }
    squared_[place] = distance;
    number_[place] = number;
  }
  [[nodiscard]] std::uint32_t number(std::size_t i) const { return number_[i]; }
  [[nodiscard]] double squared(std::size_t i) const { return squared_[i]; }

 private:
  [[nodiscard]] bool before(double distance, std::uint32_t number, std::size_t place) const {
    return distance < squared_[place] || (distance == squared_[place] && number < number_[place]);
  }
  std::size_t size_, found_ = 0;
  std::array<double, most_neighbours> squared_{};
  std::array<std::uint32_t, most_neighbours> number_{};
};

}  // namespace

struct PointSearch::Tree {
  std::vector<Entry> entries;
  std::vector<Split> splits;  ///< a whole binary tree: node i has the children 2 i + 1 and 2 i + 2
  std::size_t first_leaf = 0;
  Box3 box;

  /// False: asked to stop.
  bool fill(const std::vector<Vec3>& points, const RunOptions& run) {
    entries.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      box.extend(points[i]);
      entries[i] = {points[i], static_cast<std::uint32_t>(i)};
    }
    std::size_t leaves = 1;
    while (leaves * leaf_points < points.size()) leaves *= 2;
    first_leaf = leaves - 1;
    splits.resize(first_leaf);
    return build(0, 0, entries.size(), run);
  }

  // Halves by count, so that the range of a node follows from its place in the tree.
  bool build(std::size_t node, std::size_t first, std::size_t last, const RunOptions& run) {
    if (node >= first_leaf) return true;
    if (last - first >= poll_points && run.should_stop()) return false;
    Box3 bounds;
    for (std::size_t i = first; i < last; ++i) bounds.extend(entries[i].place);
    const Vec3 extent = bounds.max - bounds.min;
    const std::uint32_t axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    const std::size_t middle = first + (last - first) / 2;
    const auto begin = entries.begin();
    std::nth_element(begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(middle),
                     begin + static_cast<std::ptrdiff_t>(last),
                     [axis](const Entry& a, const Entry& b) { return a.place[axis] < b.place[axis]; });
    splits[node] = {entries[middle].place[axis], axis};
    return build(2 * node + 1, first, middle, run) && build(2 * node + 2, middle, last, run);
  }

  /// A part of the tree that is still to be seen: how far p is from its part of space, along each axis and squared.
  struct Rest {
    std::size_t node, first, last;
    std::array<double, 3> away;
    double bound;
  };

  template <class Found>
  void visit(Found& found, const std::array<double, 3>& p) const {
    std::array<Rest, 64> rest;
    std::size_t left = 0;
    rest[left++] = {0, 0, entries.size(), {}, 0};
    while (left > 0) {
      Rest here = rest[--left];
      if (here.bound > found.worst() * bound_slack) continue;
      while (here.node < first_leaf) {
        const Split& split = splits[here.node];
        const double d = p[split.axis] - split.at;
        const std::size_t middle = here.first + (here.last - here.first) / 2, child = 2 * here.node + 1;
        Rest& far = rest[left++];
        far.away = here.away;
        far.away[split.axis] = d;
        far.bound = far.away[0] * far.away[0] + far.away[1] * far.away[1] + far.away[2] * far.away[2];
        if (d < 0) {
          far.node = child + 1, far.first = middle, far.last = here.last;
          here.node = child, here.last = middle;
        } else {
          far.node = child, far.first = here.first, far.last = middle;
          here.node = child + 1, here.first = middle;
        }
      }
      for (std::size_t i = here.first; i < here.last; ++i) {
        const Vec3 q = entries[i].place;
        const double x = q.x - p[0], y = q.y - p[1], z = q.z - p[2], squared = x * x + y * y + z * z;
        if (squared <= found.worst()) found.add(squared, entries[i].number);
      }
    }
  }
  template <class Found>
  Found find(const Vec3& p, Found found) const {
    visit(found, {p.x, p.y, p.z});
    return found;
  }
};

std::optional<PointSearch> PointSearch::make(std::vector<Vec3> points, const RunOptions& run) {
  assert(!points.empty());
  auto tree = std::make_unique<Tree>();
  if (!tree->fill(points, run)) return std::nullopt;
  return PointSearch(std::move(tree));
}
PointSearch::PointSearch(std::unique_ptr<const Tree> tree) : tree_(std::move(tree)) {}
PointSearch::PointSearch(PointSearch&&) noexcept = default;
PointSearch& PointSearch::operator=(PointSearch&&) noexcept = default;
PointSearch::~PointSearch() = default;

const Box3& PointSearch::box() const { return tree_->box; }

std::int64_t PointSearch::nearest(Vec3 p) const { return tree_->find(p, NearestOne{}).number; }

// Shepard 1968. Divided by the nearest's distance before the power, so that nothing overflows.
Stencil PointSearch::inverse_distance(Vec3 p, double power) const {
  const NearestMany nearest = tree_->find(p, NearestMany(std::min(most_neighbours, tree_->entries.size())));
  Stencil stencil;
  if (nearest.squared(0) == 0) {
    stencil.add(nearest.number(0), 1);
    return stencil;
  }
  double sum = 0;
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    stencil.add(nearest.number(i), std::pow(nearest.squared(0) / nearest.squared(i), power / 2));
  }
  for (std::size_t i = 0; i < stencil.count; ++i) sum += stencil.weight[i];
  for (std::size_t i = 0; i < stencil.count; ++i) stencil.weight[i] /= sum;
  return stencil;
}

}  // namespace meso::fields
