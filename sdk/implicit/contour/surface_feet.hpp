// SPDX-License-Identifier: Apache-2.0
#pragma once
// How far points are from the surface of a field, and where on the surface they belong: by its values alone.

#include <cmath>
#include <functional>
#include <span>
#include <vector>

#include "meso/implicit/grid_source.hpp"

namespace meso::implicit {

/// A point near the surface. Bits of `planes`, as planes_of() has them: it may move in these planes of the box only.
struct PointNearSurface {
  Vec3 point;
  unsigned planes = 0;
  double slope = 0;         ///< about that of the field nearby; 0: not known
  Vec3 gradient{};          ///< about that of the field here; 0: not known
  double value = HUGE_VAL;  ///< of the field, if the gradient is known
  Vec3 ahead{};             ///< where outside is by the mesh, of any length; 0: not known
  double most = HUGE_VAL;   ///< no farther than that
};

struct Foot {
  Vec3 point;
  double distance = 0;
  Vec3 gradient;  ///< of the field at the point or beside it
};

/// From a point up to that far to both sides.
struct Ray {
  Vec3 from, along;
  bool hit = false;
};

/// One thread's.
class SurfaceFeet {
 public:
  SurfaceFeet(const GridSource& source, std::function<bool()> go_on);

  /// How far points are, and no less than that: where the field changes its sign between a point and another, the
  /// surface is no farther than the other. Taken on trust is |f| / |grad f| where it is a small part of `limit`. Where
  /// no change of sign is found, it is `most`.
  void distances(std::span<const PointNearSurface> points, double limit, std::vector<double>& out);
  /// The feet of points to within `accuracy`, by Newton's method along the gradient. It is taken anew where it has not
  /// brought the point much closer.
  void feet(std::span<const PointNearSurface> points, double accuracy, std::vector<Foot>& out);
  /// Moves points along their rays to where the surface is, to within `accuracy`; outwards from inside, and the other
  /// way. It is looked for at an eighth, a quarter, half and all of the way.
  void shoot(std::span<Ray> rays, double accuracy);
  /// The shortest of 26 rays around each point to where the surface is, to within `accuracy`; no farther than `most`.
  /// Not hit: nothing was found.
  [[nodiscard]] std::vector<Ray> search(std::span<const PointNearSurface> points, double accuracy);
  /// Whether the field changes its sign within `accuracy` of points: along a direction or an axis, to both sides.
  void check(std::span<const Vec3> points, std::span<const Vec3> directions, double accuracy,
             std::vector<char>& on_surface);
  /// The values at points, nothing else.
  void values(std::span<const Vec3> points, std::vector<double>& out) { ask(points, out); }
  /// Slopes by differences, of a hundred-thousandth of a cell.
  void slopes(std::span<const Vec3> points, std::vector<Vec3>& out, std::vector<double>& values);

  /// How far the corners of a cell are apart.
  [[nodiscard]] double cell() const { return norm(Vec3{grid_.spacing(0), grid_.spacing(1), grid_.spacing(2)}); }

 private:
  void ask(std::span<const Vec3> points, std::vector<double>& out);
  [[nodiscard]] std::vector<std::size_t> not_certain(std::span<const PointNearSurface> points, double limit,
                                                     std::vector<double>& out);
  void distances_of_part(std::span<const PointNearSurface> points, double limit, std::vector<double>& out);
  void measure_in_planes(std::span<const PointNearSurface> points, double limit, std::vector<double>& out);
  void find_distances(std::span<const PointNearSurface> points, double limit, std::vector<double>& out);

  const Grid& grid_;
  std::unique_ptr<GridSampler> sampler_;
  std::function<bool()> go_on_;
  std::vector<Vec3> around_, moving_;
  std::vector<double> around_values_, values_, beyond_values_;
};

}  // namespace meso::implicit
