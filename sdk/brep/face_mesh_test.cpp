// SPDX-License-Identifier: Apache-2.0
// Solids with faces narrower than the chords of their edges are off.
#include <gtest/gtest.h>

#include <map>

#include "meso/brep/gaps.hpp"
#include "meso/brep/measure.hpp"
#include "meso/brep/triangles.hpp"
#include "shape_to_body.hpp"
#include "test_crescents.hpp"

namespace meso::brep {
namespace {

using Point = std::array<double, 3>;

/// Sides that are not gone along once in each direction.
std::size_t open_sides(const Body& body, std::size_t& triangles) {
  std::map<std::pair<Point, Point>, int> sides;
  visit_triangles(body, [&](std::span<const Triangle> block) {
    triangles += block.size();
    for (const Triangle& t : block)
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 &p = t[k], &q = t[(k + 1) % 3];
        const Point a{p.x, p.y, p.z}, b{q.x, q.y, q.z};
        sides[std::minmax(a, b)] += a < b ? 1 : -1;
      }
  });
  std::size_t open = 0;
  for (const auto& [side, sum] : sides) open += sum != 0;
  return open;
}

class ThinPrism : public testing::TestWithParam<CrescentOn> {};
INSTANTIATE_TEST_SUITE_P(Surfaces, ThinPrism, testing::ValuesIn(crescents()),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(ThinPrism, ClosesWithTheChordsThatAreAskedFor) {
  const CrescentOn& on = GetParam();
  gp_Pnt at;
  gp_Vec u, v;
  on.surface->D1(on.middle.X(), on.middle.Y(), at, u, v);
  for (const double width : {0.1, 0.016, 1e-3}) {
    const TopoDS_Shape prism = BRepPrimAPI_MakePrism(crescent(on, width), u.Crossed(v).Normalized());
    const TopoDS_Solid solid = TopoDS::Solid(prism);
    DiagnosticSink sink;
    const auto body = shape_to_body(solid, {.mesh = MeshTolerance{.deflection_mm = 0.1, .angle = 0.5}}, sink);
    ASSERT_TRUE(body) << width << ' ' << (sink.diagnostics().empty() ? "" : render(sink.diagnostics()[0]));
    std::size_t triangles = 0;
    EXPECT_EQ(open_sides(*body, triangles), 0u) << width;
    EXPECT_LT(triangles, 400u) << width << ": all edges are divided and divided again";
    const Gaps gaps = measure_gaps(*body);
    EXPECT_LE(gaps.triangle_mm, 0.1) << width;
    EXPECT_NEAR(volume_of_triangles(*body) + gaps.triangles_mm3, measure(*body).volume,
                0.1 * gaps.triangles_abs_mm3 + 1e-6)
        << width;
  }
}

}  // namespace
}  // namespace meso::brep
