// SPDX-License-Identifier: Apache-2.0
// Bodies through the exporters and back: STEP is judged by OpenCASCADE's reader, STL by the strict one of ours.
#include <gtest/gtest.h>
#include <unistd.h>

#include <STEPControl_Reader.hxx>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "meso/brep/audit.hpp"
#include "meso/brep/measure.hpp"
#include "meso/brep/placement.hpp"
#include "meso/brep/triangles.hpp"
#include "meso/export_step/write_step.hpp"
#include "meso/export_stl/write_stl.hpp"
#include "meso/import_surface_mesh/read_stl.hpp"
#include "meso/mesh/audit_mesh.hpp"
#include "shape_to_body.hpp"
#include "test_bodies.hpp"

namespace meso::brep {
namespace {

class RoundTrip : public testing::TestWithParam<ClosedForm> {};
INSTANTIATE_TEST_SUITE_P(ClosedForms, RoundTrip, testing::ValuesIn(closed_forms()),
                         [](const auto& test) { return test.param.name; });

std::string step_of(const Body& body) {
  StringSink sink;
  EXPECT_TRUE(write_step(body, {}, sink).complete);
  return sink.text();
}

TopoDS_Shape read_step(const std::string& text) {
  const auto path = std::filesystem::temp_directory_path() / ("meso_round_trip_" + std::to_string(getpid()) + ".stp");
  std::ofstream(path, std::ios::binary) << text;
  STEPControl_Reader reader;
  EXPECT_EQ(reader.ReadFile(path.c_str()), IFSelect_RetDone);
  reader.TransferRoots();
  std::filesystem::remove(path);
  return reader.OneShape();
}

// Edges used once: the reader does not say when it has left a shell open.
int free_edges(const TopoDS_Shape& shape) {
  TopTools_IndexedDataMapOfShapeListOfShape faces_of;
  TopExp::MapShapesAndUniqueAncestors(shape, TopAbs_EDGE, TopAbs_FACE, faces_of);
  int count = 0;
  for (int i = 1; i <= faces_of.Extent(); ++i) {
    const TopoDS_Edge& edge = TopoDS::Edge(faces_of.FindKey(i));
    const bool seam = faces_of(i).Extent() == 1 && BRep_Tool::IsClosed(edge, TopoDS::Face(faces_of(i).First()));
    count += faces_of(i).Extent() != 2 && !seam && !BRep_Tool::Degenerated(edge);
  }
  return count;
}

void expect_reads_as(const std::string& text, int solids, double volume, double area) {
  const TopoDS_Shape shape = read_step(text);
  ASSERT_FALSE(shape.IsNull());
  int found = 0;
  for (TopExp_Explorer it(shape, TopAbs_SOLID); it.More(); it.Next()) ++found;
  EXPECT_EQ(found, solids);
  EXPECT_TRUE(BRepCheck_Analyzer(shape).IsValid());
  EXPECT_EQ(free_edges(shape), 0);
  GProp_GProps volume_properties, area_properties;
  BRepGProp::VolumeProperties(shape, volume_properties);
  BRepGProp::SurfaceProperties(shape, area_properties, 1e-6);  // without a tolerance 0.2 % off on an ellipsoid
  EXPECT_NEAR(volume_properties.Mass() / volume, 1, 1e-4);
  EXPECT_NEAR(area_properties.Mass() / area, 1, 1e-4);
}

TEST_P(RoundTrip, StepReadsBackAsTheSameSolid) {
  DiagnosticSink sink;
  const auto body = shape_to_body(GetParam().shape, {}, sink);
  ASSERT_TRUE(body);
  expect_reads_as(step_of(*body), 1, GetParam().volume, GetParam().area);
}

TEST_P(RoundTrip, StlIsWatertightAndConvergesFromTheChords) {
  DiagnosticSink sink;
  const auto body = shape_to_body(GetParam().shape, {.mesh = MeshTolerance{.deflection_mm = 0.01, .angle = 0.1}}, sink);
  ASSERT_TRUE(body);
  StringSink stl;
  EXPECT_TRUE(write_stl(triangles_of(*body), StlFormat::binary, stl).complete);
  const auto mesh = read_stl(stl.text(), "", sink);
  ASSERT_TRUE(mesh);
  const MeshAudit audit = audit_mesh(*mesh);
  EXPECT_EQ(audit.unmatched_half_edges, 0u);
  EXPECT_EQ(audit.flipped_edges, 0u);
  EXPECT_EQ(audit.multiple_edges, 0u);
  EXPECT_NEAR(audit.volume / GetParam().volume, 1, 0.01);
  EXPECT_NEAR(audit.area / GetParam().area, 1, 0.01);
  const Box3 exact = measure(*body).box;
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LE(exact.min[i], audit.box.min[i] + 1e-6);
    EXPECT_GE(exact.max[i], audit.box.max[i] - 1e-6);
    EXPECT_NEAR(exact.min[i], audit.box.min[i], 0.02);
    EXPECT_NEAR(exact.max[i], audit.box.max[i], 0.02);
  }
}

// An oblique lattice: nothing is right by symmetry.
const Mat3 oblique = Mat3::from_columns({2, 0, 0}, {0.5, 3, 0}, {-0.25, 0.75, 2.5});

TEST(RoundTripLattice, CellsShareVerticesAndEdges) {
  const auto [body, count] = voxels(oblique, {5, 5, 3}, is_bar);
  const Audit a = audit(body);
  EXPECT_TRUE(a.clean());
  const double volume = static_cast<double>(count) * determinant(oblique);
  const Measures m = measure(body);
  EXPECT_NEAR(m.volume / volume, 1, 1e-12);
  EXPECT_NEAR(norm(m.centroid - oblique * Vec3{2.5, 2.5, 1.5}), 0, 1e-12);
  const std::string step = step_of(body);
  const auto occurrences = [&](const std::string& word) {
    std::size_t n = 0;
    for (auto at = step.find(word); at != std::string::npos; at = step.find(word, at + 1)) ++n;
    return n;
  };
  EXPECT_EQ(occurrences("=EDGE_CURVE("), a.edges);
  EXPECT_EQ(occurrences("=ADVANCED_FACE("), a.faces);
  EXPECT_EQ(occurrences("=DIRECTION("), 6u + 2);  // three edges, three normals; two of the file's own frame
  expect_reads_as(step, 1, volume, m.area);
}

TEST(RoundTripLattice, PlacementsTurnScaleAndShift) {
  Voxels v = voxels(oblique, {3, 3, 3}, is_bar);
  Affine& placement = v.body.solids[0].outer.placement;
  placement = {rotation(Vec3{1, 2, 2} / 3, 0.7), {100, -50, 25}};
  for (double& entry : placement.linear.m) entry *= 1.5;
  const double volume = static_cast<double>(v.count) * determinant(oblique) * 1.5 * 1.5 * 1.5;
  const Measures m = measure(v.body);
  EXPECT_NEAR(m.volume / volume, 1, 1e-12);
  EXPECT_NEAR(norm(m.centroid - placement * (oblique * Vec3{1.5, 1.5, 1.5})), 0, 1e-9);
  expect_reads_as(step_of(v.body), 1, volume, m.area);
  StringSink stl;
  DiagnosticSink sink;
  EXPECT_TRUE(write_stl(triangles_of(v.body), StlFormat::ascii, stl).complete);
  const auto mesh = read_stl(stl.text(), "", sink);
  ASSERT_TRUE(mesh);
  EXPECT_TRUE(audit_mesh(*mesh).watertight());
  EXPECT_NEAR(audit_mesh(*mesh).volume / volume, 1, 1e-5);
}

// One hollow, many places: a template shared by every void.
TEST(RoundTripVoids, InstancesAreRotatedAndPlaced) {
  DiagnosticSink sink;
  auto body = shape_to_body(BRepPrimAPI_MakeBox(gp_Pnt(0, 0, 0), 40, 10, 10).Shape(), {}, sink);
  const TopoDS_Shape cone = BRepPrimAPI_MakeCone(2, 1, 3).Shape();
  const auto hollow = shape_to_body(cone.Reversed(), {}, sink);
  ASSERT_TRUE(body && !hollow);  // inside out on its own
  const TopoDS_Shell inward = TopoDS::Shell(TopExp_Explorer(cone.Reversed(), TopAbs_SHELL).Current());
  const auto geometry = std::make_shared<const Template>(shell_to_template(inward, {}));
  for (int i = 0; i < 4; ++i)
    body->solids[0].voids.push_back(whole_template(geometry, {rotation(Vec3{0.6, 0, 0.8}, i), {5.0 + 10 * i, 5, 5}}));
  const double cone_volume = std::numbers::pi * 3 / 3 * (4 + 2 + 1);
  const Measures m = measure(*body);
  EXPECT_NEAR(m.volume, 4000 - 4 * cone_volume, 1e-9);
  EXPECT_TRUE(audit(*body).clean());
  expect_reads_as(step_of(*body), 1, m.volume, m.area);
}

TEST(RoundTripVoids, LocatedShellsShareOneTemplate) {
  const TopoDS_Shape ball = BRepPrimAPI_MakeSphere(1).Shape();
  const TopoDS_Shell inward = TopoDS::Shell(TopExp_Explorer(ball, TopAbs_SHELL).Current().Reversed());
  BRep_Builder builder;
  TopoDS_Solid solid = TopoDS::Solid(BRepPrimAPI_MakeBox(gp_Pnt(0, 0, 0), 12, 4, 4).Shape());
  for (const double x : {2.0, 6.0, 10.0}) {
    gp_Trsf move;
    move.SetTranslation(gp_Vec(x, 2, 2));
    builder.Add(solid, inward.Moved(move));
  }
  DiagnosticSink sink;
  const auto body = shape_to_body(solid, {}, sink);
  ASSERT_TRUE(body);
  ASSERT_EQ(body->solids[0].voids.size(), 3u);
  EXPECT_EQ(body->solids[0].voids[0].geometry, body->solids[0].voids[2].geometry);
  EXPECT_NEAR(measure(*body).volume, 192 - 4 * std::numbers::pi, 1e-9);
}

/// A ball and struts from its centre.
TopoDS_Shape ball_and_struts(double ball, double strut, const std::vector<gp_Dir>& directions) {
  TopoDS_Shape shape = BRepPrimAPI_MakeSphere(ball).Shape();
  for (const gp_Dir& d : directions)
    shape = BRepAlgoAPI_Fuse(shape, BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(), d), strut, 3).Shape()).Shape();
  return shape;
}

// Its seam is interrupted where struts leave the ball. Four struts that meet on either side leave a belt of it.
TEST(RoundTripBalls, AreReadOnTheirOwnSideOfEveryLoop) {
  std::vector<gp_Dir> corners;
  for (const double x : {-2.87, 2.87})
    for (const auto& [y, z] : {std::pair(2.1, 2.02), {2.1, -2.02}, {-2.1, -2.02}, {-2.1, 2.02}})
      corners.emplace_back(x, y, z);
  const gp_Dir right(1, 0, 0), left(-1, 0, 0), up(0, 0, 1);
  for (const auto& directions : std::vector<std::vector<gp_Dir>>{{right}, {right, left}, {right, up}, corners}) {
    const TopoDS_Shape shape = ball_and_struts(0.829, 0.49, directions);
    DiagnosticSink sink;
    const auto body = shape_to_body(shape, {}, sink);
    ASSERT_TRUE(body);
    const Measures m = measure(*body);
    expect_reads_as(step_of(*body), 1, m.volume, m.area);
  }
}

TEST(ShapeToBodyErrors, AShapeWithoutSolids) {
  DiagnosticSink sink;
  EXPECT_FALSE(shape_to_body(TopExp_Explorer(BRepPrimAPI_MakeBox(1, 1, 1).Shape(), TopAbs_FACE).Current(), {}, sink));
  EXPECT_EQ(sink.diagnostics().at(0).code, Code::geometry_no_solid);
}

}  // namespace
}  // namespace meso::brep
