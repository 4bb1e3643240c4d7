// SPDX-License-Identifier: Apache-2.0
#include "faces.hpp"

#include <numeric>
#include <span>

namespace meso {
namespace {

using Corners = std::span<const std::uint32_t>;

class Polygon {
 public:
  Polygon(Corners corners, const std::vector<Vec3>& points, std::vector<std::array<std::uint32_t, 3>>& out)
      : corners_(corners), points_(points), out_(out) {
    // Newell: twice the area vector, whatever the corners' order and planarity.
    for (std::size_t i = 0; i < corners.size(); ++i)
      normal_ += cross(at(i) - at(0), at((i + 1) % corners.size()) - at(0));
  }

  void part() {
    if (corners_.size() == 3) return add(0, 1, 2);
    if (corners_.size() == 4) return part_quadrilateral();
    std::vector<std::size_t> rest(corners_.size());
    std::iota(rest.begin(), rest.end(), std::size_t{0});
    constexpr std::size_t most_corners = 1000;
    while (rest.size() > 3 && rest.size() <= most_corners && cut_ear(rest)) {
    }
    for (std::size_t i = 2; i < rest.size(); ++i) add(rest[0], rest[i - 1], rest[i]);
  }

 private:
  [[nodiscard]] Vec3 at(std::size_t i) const { return points_[corners_[i]]; }
  void add(std::size_t i, std::size_t j, std::size_t k) { out_.push_back({corners_[i], corners_[j], corners_[k]}); }
  /// Positive if the corners turn the way the polygon does.
  [[nodiscard]] double turn(std::size_t i, std::size_t j, std::size_t k) const {
    return dot(cross(at(j) - at(i), at(k) - at(i)), normal_);
  }

  void part_quadrilateral() {
    const bool first_inside = turn(0, 1, 2) > 0 && turn(0, 2, 3) > 0;
    const bool second_inside = turn(1, 2, 3) > 0 && turn(1, 3, 0) > 0;
    const bool first = first_inside != second_inside ? first_inside : norm(at(2) - at(0)) <= norm(at(3) - at(1));
    if (first) {
      add(0, 1, 2);
      add(0, 2, 3);
    } else {
      add(1, 2, 3);
      add(1, 3, 0);
    }
  }

  /// False if there is none: the polygon crosses itself.
  bool cut_ear(std::vector<std::size_t>& rest) {
    const std::size_t n = rest.size();
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t a = rest[(i + n - 1) % n], b = rest[i], c = rest[(i + 1) % n];
      if (!(turn(a, b, c) > 0) || holds_corner(rest, a, b, c)) continue;
      add(a, b, c);
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
      return true;
    }
    return false;
  }
  [[nodiscard]] bool holds_corner(const std::vector<std::size_t>& rest, std::size_t a, std::size_t b,
                                  std::size_t c) const {
    for (const std::size_t p : rest) {
      if (p == a || p == b || p == c) continue;
      if (at(p) == at(a) || at(p) == at(b) || at(p) == at(c)) continue;
      if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return true;
    }
    return false;
  }

  Corners corners_;
  const std::vector<Vec3>& points_;
  std::vector<std::array<std::uint32_t, 3>>& out_;
  Vec3 normal_;
};

}  // namespace

std::vector<std::array<std::uint32_t, 3>> triangles_of(const Faces& faces, const std::vector<Vec3>& points) {
  std::vector<std::array<std::uint32_t, 3>> out;
  out.reserve(faces.corners.size() - 2 * faces.sizes.size());
  const Corners corners(faces.corners);
  std::size_t first = 0;
  for (const std::uint32_t size : faces.sizes) {
    if (size == 3)
      out.push_back({corners[first], corners[first + 1], corners[first + 2]});
    else
      Polygon(corners.subspan(first, size), points, out).part();
    first += size;
  }
  return out;
}

}  // namespace meso
