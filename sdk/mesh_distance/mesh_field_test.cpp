// SPDX-License-Identifier: Apache-2.0
#include "meso/mesh_distance/mesh_field.hpp"

#include <gtest/gtest.h>

#include "test_meshes.hpp"

namespace meso::implicit {
namespace {

std::shared_ptr<const MeshField> field_of(const TriangleMesh& mesh) {
  DiagnosticSink sink;
  auto field = MeshField::make(mesh, "mesh", {}, sink);
  EXPECT_TRUE(field);
  EXPECT_TRUE(sink.diagnostics().empty());
  return field;
}

TEST(MeshField, IcosphereIsABallUpToItsFacets) {
  const TriangleMesh mesh = icosphere(4);
  const auto field = field_of(mesh);
  const double sagitta = facet_sagitta(mesh);
  EXPECT_TRUE(field->quality().closed);
  Random random(1);
  for (int i = 0; i < 20'000; ++i) {
    const Vec3 p = random.in_cube(1.5);
    const double d = field->value(p);
    ASSERT_LE(d, norm(p) - 1 + sagitta + 1e-14);
    ASSERT_GE(d, norm(p) - 1 - 1e-14);
  }
}

}  // namespace
}  // namespace meso::implicit
