// SPDX-License-Identifier: Apache-2.0
#include "import_solid.hpp"

#include <gtest/gtest.h>

#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Writer.hxx>
#include <Interface_Static.hxx>
#include <STEPControl_Writer.hxx>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <sstream>

#include "boolean.hpp"
#include "meso/brep/read_step.hpp"
#include "meso/brep/step_text.hpp"

namespace meso::brep {
namespace {

const std::filesystem::path beam = std::filesystem::path(MESO_SOURCE_DIR) / "examples/ibeam/ibeam.step";

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos);
  return text.replace(at, from.size(), to);
}

/// Two triangles for each side of a cube of edge 10 at the origin.
std::string cube_stl(bool open = false) {
  constexpr std::array<std::array<int, 4>, 6> sides{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  std::ostringstream out;
  out << "solid cube\n";
  const auto facet = [&](int a, int b, int c) {
    out << "facet normal 0 0 0\nouter loop\n";
    for (const int corner : {a, b, c})
      out << "vertex " << (corner & 1) * 10 << ' ' << (corner >> 1 & 1) * 10 << ' ' << (corner >> 2) * 10 << '\n';
    out << "endloop\nendfacet\n";
  };
  for (std::size_t i = open ? 1 : 0; i < sides.size(); ++i) {
    facet(sides[i][0], sides[i][1], sides[i][2]);
    facet(sides[i][0], sides[i][2], sides[i][3]);
  }
  out << "endsolid cube\n";
  return out.str();
}

class ImportSolids : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              ("meso_import_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path written(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  std::optional<Solids> imported(const eval::ImportShape& import) {
    return import_solids(import, {}, {}, {source_, run_, sink_});
  }
  void expect_refused(const std::filesystem::path& file, Code code) {
    sink_ = DiagnosticSink();
    EXPECT_FALSE(imported({.file = file})) << file;
    ASSERT_FALSE(sink_.diagnostics().empty());
    EXPECT_EQ(sink_.diagnostics().front().code, code) << render(sink_.diagnostics().front());
  }

  std::filesystem::path folder_;
  SourceMap source_;
  RunOptions run_;
  DiagnosticSink sink_;
};

TEST_F(ImportSolids, StepHasItsOwnUnit) {
  const auto solids = imported({.file = beam});
  ASSERT_TRUE(solids);
  ASSERT_EQ(solids->size(), 1u);
  EXPECT_NEAR(volume_of(solids->front()), 280000, 1e-3);
}

TEST_F(ImportSolids, StlIsScaledAndMoved) {
  const auto solids = imported(
      {.file = written("cube.stl", cube_stl()), .scale = 25.4, .transform = Affine::from_translation({1, 2, 3})});
  ASSERT_TRUE(solids);
  ASSERT_EQ(solids->size(), 1u);
  EXPECT_NEAR(volume_of(solids->front()), std::pow(254, 3), 1e-3);
  EXPECT_TRUE(BRepCheck_Analyzer(solids->front()).IsValid());
  EXPECT_NEAR(box_of(solids->front()).min.z, 3, 1e-9);
}

TEST_F(ImportSolids, OpenSurfaces) {
  expect_refused(written("open.stl", cube_stl(true)), Code::import_not_closed);
  // One face less in the shell: OpenCASCADE gives an open shell without a word.
  const std::string step = text_of(beam);
  const auto shell = step.find("CLOSED_SHELL(''");
  ASSERT_NE(shell, std::string::npos);
  const auto first = step.find('#', shell), second = step.find('#', first + 1);
  expect_refused(written("open.step", step.substr(0, first) + step.substr(second)), Code::import_not_closed);
}

TEST_F(ImportSolids, FilesThatAreNotStep) {
  const std::string step = text_of(beam);
  expect_refused(written("empty.step", ""), Code::import_unreadable);
  expect_refused(written("half.step", step.substr(0, step.size() / 2)), Code::import_unreadable);
  expect_refused(written("most.step", step.substr(0, step.size() * 95 / 100)), Code::import_unreadable);
  expect_refused(written("garbage.stp", "not a step file"), Code::import_unreadable);
  expect_refused(written("header.step", step.substr(0, step.find("DATA;")) + "DATA;\nENDSEC;\nEND-ISO-10303-21;\n"),
                 Code::import_unreadable);
  expect_refused(folder_ / "missing.step", Code::import_unreadable);
  expect_refused(written("nan.step", replaced(step, "CARTESIAN_POINT('',(", "CARTESIAN_POINT('',(NAN,")),
                 Code::import_unreadable);
}

TEST_F(ImportSolids, StepInOtherUnits) {
  const std::string step = text_of(beam);
  const auto volume = [&](const std::string& unit) {
    const auto solids = imported(
        {.file = written("unit.step", replaced(step, "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));", unit))});
    return solids && solids->size() == 1 ? volume_of(solids->front()) : 0;
  };
  EXPECT_NEAR(volume("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.CENTI.,.METRE.));") / 280000e3, 1, 1e-6);
  EXPECT_NEAR(volume("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));") / 280000e9, 1, 1e-6);
  EXPECT_NEAR(volume("(CONVERSION_BASED_UNIT('INCH',#9001)LENGTH_UNIT()NAMED_UNIT(#9002));\n"
                     "#9001=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#9003);\n"
                     "#9002=DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);\n"
                     "#9003=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));") /
                  (280000 * std::pow(25.4, 3)),
              1, 1e-6);
}

TEST_F(ImportSolids, StepThatReferencesItself) {
  const std::string step = text_of(beam);
  for (const char* entity : {"=CLOSED_SHELL('',(", "=MANIFOLD_SOLID_BREP('',", "=AXIS2_PLACEMENT_3D('',"}) {
    const auto at = step.find(entity), line = step.rfind('#', at), first = step.find('#', at);
    const auto end = step.find_first_of(",)", first);
    const std::string own = step.substr(line, at - line);
    sink_ = DiagnosticSink();
    const auto solids = imported({.file = written("cyclic.step", step.substr(0, first) + own + step.substr(end))});
    EXPECT_FALSE(solids) << entity;
    EXPECT_TRUE(sink_.has_errors());
  }
}

TEST_F(ImportSolids, StepWithBytesOverwritten) {
  // Sixty bytes anywhere: OpenCASCADE tells of success, and gives nothing or an open shell.
  const std::string step = text_of(beam);
  int refused = 0;
  std::uint32_t state = 7;
  const auto next = [&] { return (state = state * 1664525u + 1013904223u) >> 8; };
  for (int n = 0; n < 12; ++n) {
    std::string broken = step;
    const std::size_t data = step.find("DATA;") + 6;
    for (int k = 0; k < 60; ++k) broken[data + next() % (step.size() - data)] = static_cast<char>('!' + next() % 90);
    sink_ = DiagnosticSink();
    const auto solids = imported({.file = written("broken.step", broken)});
    if (!solids) {
      EXPECT_TRUE(sink_.has_errors()) << n;
      ++refused;
      continue;
    }
    for (const TopoDS_Shape& solid : *solids) {
      EXPECT_EQ(edge_uses(solid).free, 0u) << n;
      EXPECT_GT(volume_of(solid), 0) << n;
    }
  }
  EXPECT_GE(refused, 6);
}

TEST_F(ImportSolids, StepWithNumbersBeyondRange) {
  const std::string step = text_of(beam);
  sink_ = DiagnosticSink();
  EXPECT_FALSE(
      imported({.file = written("huge.step", replaced(step, "CARTESIAN_POINT('',(", "CARTESIAN_POINT('',(1E400,"))}));
  EXPECT_TRUE(sink_.has_errors());
}

TEST_F(ImportSolids, ReferencesThatLeadNowhere) {
  EXPECT_FALSE(reference_fault("#1=A('#9',#2);\n#2=B((#3),#3);#3=C();"));
  EXPECT_TRUE(reference_fault("#1=A(#2);#2=B(#3);"));
  EXPECT_TRUE(reference_fault("#1=A(#2);#2=B();#2=C();"));
  EXPECT_TRUE(reference_fault("#1=A(#2);#2=B(#1);"));
}

TEST_F(ImportSolids, SolidsThatOverlapAreUnited) {
  // Two cubes of edge 10, the second moved by 5: their volumes do not add up.
  const std::string one = cube_stl();
  std::string other = one;
  for (std::size_t at = 0; (at = other.find("vertex ", at)) != std::string::npos; at += 7)
    other.replace(at + 7, other[at + 7] == '1' ? 2 : 1, other[at + 7] == '1' ? "15" : "5");
  const auto solids = imported({.file = written("two.stl", one + other)});
  ASSERT_TRUE(solids);
  double volume = 0;
  for (const TopoDS_Shape& solid : *solids) volume += volume_of(solid);
  EXPECT_NEAR(volume, 1500, 1e-6);
}

TEST_F(ImportSolids, SurfacesThatCrossThemselves) {
  // A tetrahedron whose bottom is drawn out, through the side over it.
  const std::array<Vec3, 5> points{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 3}, {6, 6, 1}}};
  std::ostringstream out;
  out << "solid spike\n";
  for (const auto& triangle : {std::array{0, 2, 4}, {2, 1, 4}, {1, 0, 4}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}) {
    out << "facet normal 0 0 0\nouter loop\n";
    for (const int i : triangle) {
      const Vec3 p = points[static_cast<std::size_t>(i)];
      out << "vertex " << p.x << ' ' << p.y << ' ' << p.z << '\n';
    }
    out << "endloop\nendfacet\n";
  }
  out << "endsolid spike\n";
  expect_refused(written("spike.stl", out.str()), Code::import_overlaps);
}

TEST_F(ImportSolids, CavitiesOfStlAreVoids) {
  // A cube of edge 10 with a cube of edge 4 taken out of its middle, and that of edge 1 standing in the cavity.
  const std::string one = cube_stl();
  const auto scaled = [&](double edge, double corner, bool inside_out) {
    std::string out;
    std::istringstream lines(one);
    std::string line, held;
    for (int vertex = 0; std::getline(lines, line);) {
      const auto at = line.find("vertex ");
      if (at == std::string::npos) {
        vertex = 0;
        out += line + '\n';
        continue;
      }
      std::istringstream numbers(line.substr(at + 7));
      double x = 0, y = 0, z = 0;
      numbers >> x >> y >> z;
      const auto put = [&](double c) { return std::to_string(corner + c / 10 * edge) + ' '; };
      const std::string text = "vertex " + put(x) + put(y) + put(z) + '\n';
      if (inside_out && ++vertex == 2)
        held = text;
      else
        out += text + (inside_out && vertex == 3 ? held : "");
    }
    return out;
  };
  const auto hollow = imported({.file = written("hollow.stl", one + scaled(4, 3, true))});
  ASSERT_TRUE(hollow);
  ASSERT_EQ(hollow->size(), 1u);
  EXPECT_NEAR(volume_of(hollow->front()), 1000 - 64, 1e-6);
  const auto nested = imported({.file = written("nested.stl", scaled(1, 4, false) + scaled(4, 3, true) + one)});
  ASSERT_TRUE(nested);
  ASSERT_EQ(nested->size(), 2u);
  EXPECT_NEAR(volume_of(nested->front()) + volume_of(nested->back()), 1000 - 64 + 1, 1e-6);
  expect_refused(written("inside_out.stl", scaled(4, 3, true)), Code::import_not_closed);
}

TEST_F(ImportSolids, NumbersThatAreNone) {
  EXPECT_TRUE(has_bad_number("#1=CARTESIAN_POINT('',(0.,nan,1.));"));
  EXPECT_TRUE(has_bad_number("#1=CARTESIAN_POINT('',(0.,-INF,1.));"));
  EXPECT_FALSE(has_bad_number("/* it's, nan */#1=A('it''s',(/*'*/1.));"));
  EXPECT_TRUE(has_bad_number("/* it's */#1=A(nan);"));
  EXPECT_FALSE(reference_fault("/* it's #7 */#1=A('#9');"));
  EXPECT_FALSE(has_bad_number("#1=PRODUCT('nan',(#2),'inf',INFO,NANO);"));
}

TEST_F(ImportSolids, UnknownFormat) { expect_refused(written("body.xyz", "x"), Code::import_no_reader); }

TEST_F(ImportSolids, ChangedFile) {
  EXPECT_FALSE(imported({.file = beam, .sha256 = std::string(64, '0')}));
  ASSERT_FALSE(sink_.diagnostics().empty());
  EXPECT_EQ(sink_.diagnostics().front().code, Code::import_changed);
}

// Files that OpenCASCADE writes here and now: BREP, and IGES as loose faces or as a solid.

TopoDS_Shape cylinder() { return BRepPrimAPI_MakeCylinder(3, 7).Solid(); }
/// An ellipsoid as a B-spline surface.
TopoDS_Shape free_form() {
  gp_GTrsf stretched;
  stretched.SetValue(1, 1, 2);
  stretched.SetValue(3, 3, 0.5);
  return BRepBuilderAPI_GTransform(BRepPrimAPI_MakeSphere(3).Solid(), stretched, true).Shape();
}
/// A box with a ball taken out of its middle.
TopoDS_Shape hollow() {
  return BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(10, 10, 10).Solid(), BRepPrimAPI_MakeSphere(gp_Pnt(5, 5, 5), 3).Solid())
      .Shape();
}
const double hollow_volume = 1000 - 36 * std::numbers::pi;

std::string brep_of(const TopoDS_Shape& shape) {
  std::ostringstream out;
  BRepTools::Write(shape, out);
  return out.str();
}

std::string iges_of(const TopoDS_Shape& shape, const char* unit, bool as_solid, const std::filesystem::path& file) {
  IGESControl_Controller::Init();
  IGESControl_Writer writer(unit, as_solid ? 1 : 0);
  writer.AddShape(shape);
  writer.ComputeModel();
  EXPECT_TRUE(writer.Write(file.string().c_str()));
  return text_of(file);
}

double volume_sum(const std::optional<Solids>& solids) {
  double sum = 0;
  for (const TopoDS_Shape& solid : solids.value_or(Solids{})) sum += volume_of(solid);
  return sum;
}

TEST_F(ImportSolids, BrepFiles) {
  const auto read = [&](const TopoDS_Shape& shape, double scale) {
    return volume_sum(imported({.file = written("a.brep", brep_of(shape)), .scale = scale}));
  };
  EXPECT_NEAR(read(BRepPrimAPI_MakeBox(2, 3, 4).Solid(), 10), 24000, 1e-6);
  EXPECT_NEAR(read(cylinder(), 1), 63 * std::numbers::pi, 1e-9);
  EXPECT_NEAR(read(free_form(), 1) / (36 * std::numbers::pi), 1, 1e-6);
  EXPECT_NEAR(read(hollow(), 1), hollow_volume, 1e-6);
  EXPECT_TRUE(is_exact_file("A.BREP"));
  EXPECT_FALSE(is_exact_file("a.stl"));
}

/// The tetrahedron whose bottom is drawn out through a side, as faces that share edges.
TopoDS_Shape spike() {
  const std::array<gp_Pnt, 5> points{gp_Pnt(0, 0, 0), gp_Pnt(4, 0, 0), gp_Pnt(0, 4, 0), gp_Pnt(1, 1, 3),
                                     gp_Pnt(6, 6, 1)};
  BRepBuilderAPI_Sewing sewing;
  for (const auto& t : {std::array<std::size_t, 3>{0, 2, 4}, {2, 1, 4}, {1, 0, 4}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}})
    sewing.Add(
        BRepBuilderAPI_MakeFace(BRepBuilderAPI_MakePolygon(points[t[0]], points[t[1]], points[t[2]], true).Wire(), true)
            .Face());
  sewing.Perform();
  const TopExp_Explorer shell(sewing.SewedShape(), TopAbs_SHELL);
  return BRepBuilderAPI_MakeSolid(TopoDS::Shell(shell.Current())).Solid();
}

std::string step_of(const TopoDS_Shape& shape, const std::filesystem::path& file) {
  STEPControl_Writer writer;
  writer.Transfer(shape, STEPControl_AsIs);
  EXPECT_EQ(writer.Write(file.string().c_str()), IFSelect_RetDone);
  return text_of(file);
}

TEST_F(ImportSolids, ExactSurfacesThatCrossThemselves) {
  expect_refused(written("spike.brep", brep_of(spike())), Code::import_overlaps);
  expect_refused(written("spike.step", step_of(spike(), folder_ / "s.step")), Code::import_overlaps);
  // A tube wider than the ring it goes around covers the middle twice.
  expect_refused(written("spindle.brep", brep_of(BRepPrimAPI_MakeTorus(3, 4).Solid())), Code::import_overlaps);
  // Walls a hundredth of the body's size apart keep clear, round ones too.
  const TopoDS_Shape pipe =
      BRepAlgoAPI_Cut(BRepPrimAPI_MakeCylinder(10, 20).Solid(), BRepPrimAPI_MakeCylinder(9.99, 20).Solid()).Shape();
  EXPECT_TRUE(imported({.file = written("pipe.brep", brep_of(pipe))}));
  EXPECT_TRUE(imported({.file = written("ring.brep", brep_of(BRepPrimAPI_MakeTorus(4.01, 4).Solid()))}));
  // Whoever looks at a file may read it all the same.
  sink_ = DiagnosticSink();
  EXPECT_TRUE(read_step(written("spike.brep", brep_of(spike())), {}, run_, sink_));
}

TEST_F(ImportSolids, FilesThatAreNotBrep) {
  const std::string text = brep_of(hollow());
  expect_refused(written("empty.brep", ""), Code::import_unreadable);
  expect_refused(written("garbage.brep", "not a brep file\n"), Code::import_unreadable);
  expect_refused(folder_ / "missing.brep", Code::import_unreadable);
  for (const double share : {0.1, 0.5, 0.9, 0.99})
    expect_refused(written("cut.brep", text.substr(0, static_cast<std::size_t>(share * double(text.size())))),
                   Code::import_unreadable);
  expect_refused(written("nan.brep", replaced(text, "10 ", "nan ")), Code::import_unreadable);
  const TopoDS_Shape face = TopExp_Explorer(cylinder(), TopAbs_FACE).Current();
  expect_refused(written("face.brep", brep_of(face)), Code::import_not_closed);
}

TEST_F(ImportSolids, IgesFilesStateTheirUnit) {
  for (const bool as_solid : {false, true}) {
    SCOPED_TRACE(as_solid ? "solid" : "loose faces");
    const auto read = [&](const TopoDS_Shape& shape, const char* unit) {
      const std::filesystem::path file = folder_ / "a.igs";
      iges_of(shape, unit, as_solid, file);
      return volume_sum(imported({.file = file}));
    };
    EXPECT_NEAR(read(BRepPrimAPI_MakeBox(2, 3, 4).Solid(), "MM"), 24, 1e-6);
    EXPECT_NEAR(read(cylinder(), "IN"), 63 * std::numbers::pi, 1e-3);
    EXPECT_NEAR(read(free_form(), "M") / (36 * std::numbers::pi), 1, 1e-5);
    EXPECT_NEAR(read(hollow(), "MM"), hollow_volume, 1e-3);
  }
}

TEST_F(ImportSolids, IgesInMemory) {
  const auto text = std::make_shared<const std::string>(iges_of(cylinder(), "MM", false, folder_ / "a.iges"));
  EXPECT_NEAR(volume_sum(imported({.file = Resource("in a package.iges", text)})), 63 * std::numbers::pi, 1e-3);
}

TEST_F(ImportSolids, FilesThatAreNotIges) {
  const std::string text = iges_of(hollow(), "MM", false, folder_ / "a.iges");
  expect_refused(written("empty.iges", ""), Code::import_unreadable);
  expect_refused(written("garbage.igs", "not an iges file\n"), Code::import_unreadable);
  expect_refused(written("cut.igs", text.substr(0, text.size() / 2)), Code::import_unreadable);
  const TopoDS_Shape face = TopExp_Explorer(cylinder(), TopAbs_FACE).Current();
  iges_of(face, "MM", false, folder_ / "face.igs");
  expect_refused(folder_ / "face.igs", Code::import_not_closed);
}

}  // namespace
}  // namespace meso::brep
