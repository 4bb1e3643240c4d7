// SPDX-License-Identifier: Apache-2.0
#include "meso/fields/point_search.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <nanoflann.hpp>

namespace meso::fields {
namespace {

constexpr std::size_t leaf_points = 12;

struct Cloud {
  std::vector<Vec3> points;

  [[nodiscard]] std::size_t kdtree_get_point_count() const { return points.size(); }
  [[nodiscard]] double kdtree_get_pt(std::uint32_t i, std::size_t axis) const { return points[i][axis]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Index = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud, double, std::uint32_t>,
                                                  Cloud, 3, std::uint32_t>;

/// The `size` nearest, by distance and then by number, so that the tree's order decides nothing.
class Nearest {
 public:
  using DistanceType = double;
  explicit Nearest(std::size_t size) : size_(size) {}

  [[nodiscard]] bool full() const { return found_ == size_; }
  [[nodiscard]] std::size_t size() const { return found_; }
  /// Just above the worst one, so that equal distances are looked at.
  [[nodiscard]] double worstDist() const {
    return full() ? std::nextafter(distance_[found_ - 1], HUGE_VAL) : std::numeric_limits<double>::max();
  }
  bool addPoint(double distance, std::uint32_t number) {
    std::size_t place = full() ? found_ - 1 : found_;
    if (full() && !before(distance, number, place)) return true;
    for (; place > 0 && before(distance, number, place - 1); --place) {
      distance_[place] = distance_[place - 1];
      number_[place] = number_[place - 1];
    }
    distance_[place] = distance;
    number_[place] = number;
    found_ = std::min(found_ + 1, size_);
    return true;
  }
  void sort() {}

  [[nodiscard]] std::uint32_t number(std::size_t i) const { return number_[i]; }
  [[nodiscard]] double squared(std::size_t i) const { return distance_[i]; }

 private:
  [[nodiscard]] bool before(double distance, std::uint32_t number, std::size_t place) const {
    return distance < distance_[place] || (distance == distance_[place] && number < number_[place]);
  }
  std::size_t size_, found_ = 0;
  std::array<double, most_neighbours> distance_{};
  std::array<std::uint32_t, most_neighbours> number_{};
};

}  // namespace

struct PointSearch::Tree {
  Cloud cloud;
  Box3 box;
  Index index;

  explicit Tree(std::vector<Vec3> points)
      : cloud{std::move(points)}, index(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(leaf_points)) {
    for (const Vec3& p : cloud.points) box.extend(p);
    index.buildIndex();
  }
  [[nodiscard]] Nearest find(Vec3 p, std::size_t count) const {
    Nearest nearest(std::min(count, cloud.points.size()));
    const double query[] = {p.x, p.y, p.z};
    index.findNeighbors(nearest, query, nanoflann::SearchParams());
    return nearest;
  }
};

PointSearch::PointSearch(std::vector<Vec3> points) {
  assert(!points.empty());
  tree_ = std::make_unique<Tree>(std::move(points));
}
PointSearch::PointSearch(PointSearch&&) noexcept = default;
PointSearch::~PointSearch() = default;

const Box3& PointSearch::box() const { return tree_->box; }

std::int64_t PointSearch::nearest(Vec3 p) const { return tree_->find(p, 1).number(0); }

// Shepard 1968. Divided by the nearest's distance before the power, so that nothing overflows.
Stencil PointSearch::inverse_distance(Vec3 p, double power) const {
  const Nearest nearest = tree_->find(p, most_neighbours);
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
