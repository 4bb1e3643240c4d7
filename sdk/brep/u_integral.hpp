// SPDX-License-Identifier: Apache-2.0
#pragma once
// What the moments of a face are made of, integrated along u: in closed form on planes, cylinders, cones, spheres and
// tori, by quadrature on every other surface. Private.

#include <array>
#include <vector>

#include "occt.hpp"

namespace meso::brep {

constexpr std::size_t moment_count = 10;
/// |n|, then p n, n and p^2 n / 2 by axis; n = dp/du x dp/dv.
using Moments = std::array<double, moment_count>;

/// f(t, weight) at 10 points of [a, b]: exact for polynomials to degree 19, and for the trigonometric polynomials of
/// quadrics to 1e-15 over a quarter turn (Gauss-Legendre).
template <typename Function>
void gauss(double a, double b, Function f) {
  constexpr std::array<double, 5> nodes{0.1488743389816312, 0.4333953941292472, 0.6794095682990244, 0.8650633666889845,
                                        0.9739065285171717};
  constexpr std::array<double, 5> weights{0.2955242247147529, 0.2692667193099963, 0.2190863625159820,
                                          0.1494513491505806, 0.0666713443086881};
  const double half = (b - a) / 2, middle = (a + b) / 2;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    f(middle - half * nodes[i], half * weights[i]);
    f(middle + half * nodes[i], half * weights[i]);
  }
}

inline void add(Moments& sum, double factor, const Moments& term) {
  for (std::size_t i = 0; i < moment_count; ++i) sum[i] += factor * term[i];
}

/// Integrals over u of one surface, from a u that all share: differences of two are those in between.
class UIntegral {
 public:
  /// `u_max` bounds what will be asked for, roughly: beyond it the last smooth span of the surface goes on.
  UIntegral(const GeomAdaptor_Surface& surface, double u_min, double u_max);

  /// From u_min to u, at v. Relative error about 1e-15 in closed form; 0.1 us there, else 10 points for each span.
  [[nodiscard]] Moments operator()(double u, double v) const;

 private:
  /// Where a surface of revolution is at one v, and its derivatives by v: how far from the axis and how far along it.
  struct Profile {
    double radius, height, radius_dv, height_dv;
  };
  [[nodiscard]] Profile profile(double v) const;
  [[nodiscard]] Moments on_plane(double u, double v) const;
  [[nodiscard]] Moments around_axis(double u, double v) const;
  [[nodiscard]] Moments by_quadrature(double u, double v) const;

  const GeomAdaptor_Surface& surface_;
  GeomAbs_SurfaceType type_;
  double u_min_;
  std::vector<double> breaks_;  ///< only of surfaces without a closed form
  // The frame of an elementary surface; handedness_ is -1 where x cross y is -z.
  std::array<double, 3> origin_{}, x_{}, y_{}, z_{};
  double handedness_ = 1;
  double ring_ = 0, radius_ = 0, sine_ = 0, cosine_ = 1;  ///< of a torus; of the rest; of a cone's half angle
};

}  // namespace meso::brep
