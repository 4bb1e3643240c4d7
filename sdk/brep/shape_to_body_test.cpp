// SPDX-License-Identifier: Apache-2.0
#include "shape_to_body.hpp"

#include <gtest/gtest.h>

#include "meso/brep/audit.hpp"
#include "meso/brep/measure.hpp"
#include "test_bodies.hpp"

namespace meso::brep {
namespace {

class ShapeToBody : public testing::TestWithParam<ClosedForm> {};
INSTANTIATE_TEST_SUITE_P(ClosedForms, ShapeToBody, testing::ValuesIn(closed_forms()),
                         [](const auto& test) { return test.param.name; });

TEST_P(ShapeToBody, MeasuresLikeTheClosedForm) {
  DiagnosticSink sink;
  const auto body = shape_to_body(GetParam().shape, {}, sink);
  ASSERT_TRUE(body) << (sink.diagnostics().empty() ? "" : render(sink.diagnostics()[0]));
  const Measures m = measure(*body);
  EXPECT_NEAR(m.volume / GetParam().volume, 1, GetParam().tolerance);
  EXPECT_NEAR(m.area / GetParam().area, 1, GetParam().tolerance);
  EXPECT_NEAR(norm(m.centroid - GetParam().centroid), 0, 1e-7);
  EXPECT_EQ(m.solids, 1u);
}

TEST_P(ShapeToBody, IsClosedAndOriented) {
  DiagnosticSink sink;
  const auto body = shape_to_body(GetParam().shape, {}, sink);
  ASSERT_TRUE(body);
  const Audit a = audit(*body);
  EXPECT_TRUE(a.clean()) << a.free_edges << " free, " << a.multiple_edges << " multiple, " << a.conflicts
                         << " conflicts, " << a.open_loops << " open loops, " << a.components << " components";
}

}  // namespace
}  // namespace meso::brep
