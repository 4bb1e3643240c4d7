// SPDX-License-Identifier: Apache-2.0
#pragma once
// How far two struts of a node run together, and the balls of nodes in which struts of many cells end.
// Millimetres.

#include <map>
#include <vector>

#include "meso/eval/shape.hpp"

namespace meso::eval {

inline constexpr double same_point = 1e-6;     ///< nodes that a mapping brings so close together are one
inline constexpr double smallest_sine = 1e-6;  ///< of half the angle between struts that have different directions

/// A strut as its node sees it. `widening`: by how much it grows thicker away from there, per length.
struct Leaving {
  Vec3 direction;
  double radius = 0, widening = 0;
};
[[nodiscard]] Leaving leaving_start(const BeamsShape& beams, const Strut& strut);
[[nodiscard]] Leaving leaving_end(const BeamsShape& beams, const Strut& strut);

enum class Parting { fine, same_direction, grow_faster };

/// Raises `radius` to where the strut has left one that leaves its node along `direction`.
[[nodiscard]] Parting part(const Leaving& strut, Vec3 direction, double& radius);
/// The same for two struts as thick and as widening as the larger of both.
[[nodiscard]] Parting part(const Leaving& a, const Leaving& b, double& radius);

/// Balls of the nodes that stand on a pole or an axis, where a circular coordinate moves nothing: struts of all cells
/// around it end there, not only of neighbours. Filled once, then safe to share.
class PoleBalls {
 public:
  /// A strut of any cell that leaves the pole for `far`.
  void add(Vec3 pole, Vec3 far, const Leaving& strut);
  /// REQUIRES: once, after the last add().
  void measure();

  struct Ball {
    double radius = 0;
    Parting parting = Parting::fine;
  };
  /// REQUIRES: a strut was added at p.
  [[nodiscard]] Ball at(Vec3 p) const;

 private:
  struct End {
    Vec3 far;
    Leaving strut;
  };
  struct Pole {
    Vec3 place;
    std::vector<End> ends{};
    Ball ball{};
  };
  static Ball ball_of(std::vector<End>& ends);
  /// Its number, or how many there are.
  [[nodiscard]] std::size_t find(Vec3 p) const;

  std::vector<Pole> poles_;
  /// By the coordinate along a direction that no axis is square to, in practice: few have the same.
  std::multimap<double, std::size_t> by_key_;
};

}  // namespace meso::eval
