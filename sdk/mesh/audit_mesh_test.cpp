// SPDX-License-Identifier: Apache-2.0
#include "meso/mesh/audit_mesh.hpp"

#include <gtest/gtest.h>

namespace meso {
namespace {

// The tetrahedron of the origin and the three unit points: volume 1/6.
TriangleMesh tetrahedron(Vec3 at = {}) {
  return {{at, at + Vec3{1, 0, 0}, at + Vec3{0, 1, 0}, at + Vec3{0, 0, 1}},
          {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

TEST(AuditMesh, MeasuresATetrahedronFarAway) {
  const MeshAudit a = audit_mesh(tetrahedron({1e6, -2e6, 3e6}));
  EXPECT_TRUE(a.watertight());
  EXPECT_NEAR(a.volume, 1.0 / 6, 1e-9);
  EXPECT_NEAR(a.area, 1.5 + std::sqrt(3) / 2, 1e-9);
  EXPECT_EQ(a.components, 1u);
  EXPECT_EQ(a.degenerate, 0u);
}

TEST(AuditMesh, CountsTheRimOfAHole) {
  TriangleMesh open = tetrahedron();
  open.triangles.pop_back();
  const MeshAudit a = audit_mesh(open);
  EXPECT_FALSE(a.watertight());
  EXPECT_EQ(a.unmatched_half_edges, 3u);
}

TEST(AuditMesh, CountsFlippedEdges) {
  TriangleMesh flipped = tetrahedron();
  std::swap(flipped.triangles[0][0], flipped.triangles[0][1]);
  EXPECT_EQ(audit_mesh(flipped).flipped_edges, 3u);
}

TEST(AuditMesh, CountsComponentsAndMultipleEdges) {
  TriangleMesh two = tetrahedron();
  const TriangleMesh other = tetrahedron({5, 0, 0});
  for (const Vec3& p : other.points) two.points.push_back(p);
  for (auto t : other.triangles) {
    for (auto& corner : t) corner += 4;
    two.triangles.push_back(t);
  }
  EXPECT_EQ(audit_mesh(two).components, 2u);
  two.triangles.push_back(two.triangles.front());
  EXPECT_EQ(audit_mesh(two).multiple_edges, 3u);
}

TEST(AuditMesh, NothingIsNotWatertight) { EXPECT_FALSE(audit_mesh({}).watertight()); }

}  // namespace
}  // namespace meso
