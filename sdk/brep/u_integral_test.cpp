// SPDX-License-Identifier: Apache-2.0
#include "u_integral.hpp"

#include <gtest/gtest.h>

#include <Geom_ConicalSurface.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_Plane.hxx>
#include <Geom_SphericalSurface.hxx>
#include <Geom_ToroidalSurface.hxx>

namespace meso::brep {
namespace {

gp_Ax3 tilted(bool is_right_handed) {
  gp_Ax3 frame(gp_Pnt(3, -4, 5), gp_Dir(1, 2, 0.5), gp_Dir(2, -1, 0));
  if (!is_right_handed) frame.YReverse();
  return frame;
}

/// The elementary surfaces, with v such that the cone has its apex on one side.
std::vector<Handle(Geom_Surface)> surfaces(bool is_right_handed) {
  const gp_Ax3 frame = tilted(is_right_handed);
  return {new Geom_Plane(frame), new Geom_CylindricalSurface(frame, 2), new Geom_ConicalSurface(frame, 0.4, 2),
          new Geom_SphericalSurface(frame, 3), new Geom_ToroidalSurface(frame, 4, 1.5)};
}

/// By many points of the surface itself: the midpoint rule, extrapolated once.
Moments summed(const GeomAdaptor_Surface& surface, double u0, double u1, double v) {
  const auto midpoints = [&](int count) {
    Moments sum{};
    const double step = (u1 - u0) / count;
    for (int i = 0; i < count; ++i) {
      gp_Pnt p;
      gp_Vec du, dv;
      surface.D1(u0 + (i + 0.5) * step, v, p, du, dv);
      const gp_Vec n = du.Crossed(dv);
      sum[0] += n.Magnitude() * step;
      for (int a = 0; a < 3; ++a) {
        const double p_a = p.Coord(a + 1), n_a = n.Coord(a + 1);
        const auto at = static_cast<std::size_t>(a);
        sum[1 + at] += p_a * n_a * step;
        sum[4 + at] += n_a * step;
        sum[7 + at] += p_a * p_a / 2 * n_a * step;
      }
    }
    return sum;
  };
  const Moments coarse = midpoints(500), fine = midpoints(1000);
  Moments best{};
  for (std::size_t i = 0; i < moment_count; ++i) best[i] = fine[i] + (fine[i] - coarse[i]) / 3;
  return best;
}

TEST(UIntegral, ClosedFormsAreWhatManyPointsOfTheSurfaceAddUpTo) {
  for (const bool is_right_handed : {true, false})
    for (const Handle(Geom_Surface) & surface : surfaces(is_right_handed))
      for (const auto& [u0, u1] : {std::pair{0.3, 0.9}, {-2.0, 4.1}, {0.0, -0.7}})
        for (const double v : {-0.8, 0.6}) {
          const GeomAdaptor_Surface adaptor(surface);
          const Moments exact = UIntegral(adaptor, u0, u1)(u1, v), sum = summed(adaptor, u0, u1, v);
          for (std::size_t i = 0; i < moment_count; ++i)
            EXPECT_NEAR(exact[i], sum[i], 1e-8) << surface->DynamicType()->Name() << " moment " << i << " at v " << v;
        }
}

TEST(UIntegral, BeyondTheApexOfAConeTheNormalTurnsAndTheAreaDoesNot) {
  const GeomAdaptor_Surface cone(new Geom_ConicalSurface(tilted(true), 0.4, 2));
  const double v = -2 / std::sin(0.4) - 1;
  const Moments exact = UIntegral(cone, 0, 1)(1, v), sum = summed(cone, 0, 1, v);
  EXPECT_GT(exact[0], 0);
  for (std::size_t i = 0; i < moment_count; ++i) EXPECT_NEAR(exact[i], sum[i], 1e-8);
}

TEST(UIntegral, NarrowIntervalsLoseNoDigits) {
  for (const Handle(Geom_Surface) & surface : surfaces(true)) {
    const GeomAdaptor_Surface adaptor(surface);
    const double width = 1e-7;
    const Moments narrow = UIntegral(adaptor, 1, 1 + width)(1 + width, 0.3), rate = summed(adaptor, 1, 1 + 1e-3, 0.3);
    for (std::size_t i = 0; i < moment_count; ++i)
      EXPECT_NEAR(narrow[i] / width, rate[i] / 1e-3, 5e-3 * std::fabs(rate[i] / 1e-3) + 0.05);
    const Moments half = UIntegral(adaptor, 1, 1 + width)(1 + width / 2, 0.3);
    for (std::size_t i = 0; i < moment_count; ++i)
      EXPECT_NEAR(2 * half[i] / narrow[i], 1, 1e-6) << surface->DynamicType()->Name() << " moment " << i;
  }
}

}  // namespace
}  // namespace meso::brep
