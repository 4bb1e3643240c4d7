// SPDX-License-Identifier: Apache-2.0
#include "in_memory.hpp"

#include <gtest/gtest.h>

#include "meso/brep/measure.hpp"
#include "shape_to_body.hpp"
#include "test_bodies.hpp"

namespace meso::brep {
namespace {

void expect_valid(const Body& body, double volume) {
  DiagnosticSink sink;
  const auto shape = to_shape(body, sink);
  ASSERT_TRUE(shape) << (sink.diagnostics().empty() ? "" : render(sink.diagnostics()[0]));
  EXPECT_TRUE(BRepCheck_Analyzer(*shape).IsValid());
  GProp_GProps properties;
  BRepGProp::VolumeProperties(*shape, properties, 1e-6);
  EXPECT_NEAR(properties.Mass() / volume, 1, 1e-5);
}

class InMemory : public testing::TestWithParam<ClosedForm> {};
INSTANTIATE_TEST_SUITE_P(ClosedForms, InMemory, testing::ValuesIn(closed_forms()),
                         [](const auto& test) { return test.param.name; });

TEST_P(InMemory, IsTheSameSolid) {
  DiagnosticSink sink;
  const auto body = shape_to_body(GetParam().shape, {}, sink);
  ASSERT_TRUE(body);
  expect_valid(*body, GetParam().volume);
}

TEST(InMemoryLattice, StitchesScaledCells) {
  const Mat3 oblique = Mat3::from_columns({2, 0, 0}, {0.5, 3, 0}, {-0.25, 0.75, 2.5});
  Voxels v = voxels(oblique, {3, 3, 3}, is_bar);
  Affine& placement = v.body.solids[0].outer.placement;
  placement = {rotation(Vec3{1, 2, 2} / 3, 0.7), {100, -50, 25}};
  for (double& entry : placement.linear.m) entry *= 2;
  expect_valid(v.body, static_cast<double>(v.count) * determinant(oblique) * 8);
  DiagnosticSink sink;
  const auto back = shape_to_body(*to_shape(v.body, sink), {}, sink);
  ASSERT_TRUE(back);
  EXPECT_EQ(measure(*back).faces, measure(v.body).faces);
}

}  // namespace
}  // namespace meso::brep
