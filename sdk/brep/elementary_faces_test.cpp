// SPDX-License-Identifier: Apache-2.0
// Cylinders, cones, balls and tori of IGES files. Truths: closed forms, the same body before it was written.
#include "elementary_faces.hpp"

#include <Geom_SurfaceOfLinearExtrusion.hxx>
#include <Geom_SurfaceOfRevolution.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Writer.hxx>
#include <filesystem>
#include <map>
#include <numbers>

#include "import_solid.hpp"
#include "realise_fixture.hpp"

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;

/// A cylinder with a ring cut into it, a cone on top of it and half a ball on that, leaning.
TopoDS_Shape lathe() {
  const gp_Ax2 top(gp_Pnt(0, 0, 10), gp::DZ()), end(gp_Pnt(0, 0, 14), gp::DZ()), ring(gp_Pnt(0, 0, 5), gp::DZ());
  TopoDS_Shape body =
      BRepAlgoAPI_Cut(BRepPrimAPI_MakeCylinder(6, 10).Solid(), BRepPrimAPI_MakeTorus(ring, 6, 1).Solid()).Shape();
  body = BRepAlgoAPI_Fuse(body, BRepPrimAPI_MakeCone(top, 6, 3, 4).Solid()).Shape();
  body = BRepAlgoAPI_Fuse(body, BRepPrimAPI_MakeSphere(end, 3, 0, pi / 2).Solid()).Shape();
  gp_Trsf lean;
  lean.SetRotation(gp_Ax1(gp_Pnt(1, 2, 3), gp_Dir(1, 0.3, 0.2)), 0.4);
  return BRepBuilderAPI_Transform(body, lean).Shape();
}
/// Pappus: of the ring half a disc is in the cylinder, its centre 4 / (3 pi) from the diameter.
const double lathe_volume = 360 * pi + 84 * pi + 18 * pi - 2 * pi * (6 - 4 / (3 * pi)) * pi / 2;

std::map<GeomAbs_SurfaceType, int> surfaces_of(const TopoDS_Shape& shape) {
  std::map<GeomAbs_SurfaceType, int> out;
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next())
    ++out[GeomAdaptor_Surface(BRep_Tool::Surface(TopoDS::Face(it.Current()))).GetType()];
  return out;
}

double volume(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties, 1e-9);
  return properties.Mass();
}

class ElementaryFaces : public RealiseTest {
 protected:
  void TearDown() override {
    RealiseTest::TearDown();
    std::filesystem::remove(file_);
  }
  const std::filesystem::path& iges(const TopoDS_Shape& shape, bool as_solid) {
    IGESControl_Controller::Init();
    IGESControl_Writer writer("MM", as_solid ? 1 : 0);
    writer.AddShape(shape);
    writer.ComputeModel();
    EXPECT_TRUE(writer.Write(file_.string().c_str()));
    return file_;
  }
  std::optional<Solids> imported(const std::filesystem::path& file) {
    sink_ = DiagnosticSink();
    return import_solids({.file = file}, {}, {}, {source_, run_, sink_});
  }

  const std::filesystem::path file_ =
      std::string("elementary_") + ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".igs";
  SourceMap source_;
  RunOptions run_;
};

TEST_F(ElementaryFaces, ComeBackFromIges) {
  for (const bool as_solid : {false, true}) {
    SCOPED_TRACE(as_solid ? "solid" : "loose faces");
    const auto solids = imported(iges(lathe(), as_solid));
    ASSERT_TRUE(solids);
    ASSERT_EQ(solids->size(), 1u);
    EXPECT_NEAR(volume(solids->front()) / lathe_volume, 1, 1e-9);
    EXPECT_TRUE(BRepCheck_Analyzer(solids->front()).IsValid());
    EXPECT_EQ(surfaces_of(solids->front()), surfaces_of(lathe()));
  }
}

/// A face between u and v of a surface, all of it the other way round if told.
TopoDS_Face face(const Handle(Geom_Surface) & surface, double u0, double u1, double v0, double v1, bool reversed) {
  const TopoDS_Face made = BRepBuilderAPI_MakeFace(surface, u0, u1, v0, v1, 1e-7).Face();
  return reversed ? TopoDS::Face(made.Reversed()) : made;
}

TEST_F(ElementaryFaces, KeepTheirSideWhicheverWayTheyAreSwept) {
  const gp_Ax1 up(gp_Pnt(1, 2, 3), gp::DZ()), down(gp_Pnt(1, 2, 3), -gp::DZ());
  const auto line = [](double dx, double dz) { return new Geom_Line(gp_Pnt(5, 2, 3), gp_Dir(dx, 0, dz)); };
  const auto circle = [](double x, bool backwards) {
    return new Geom_Circle(gp_Ax2(gp_Pnt(x, 2, 3), backwards ? gp::DY() : -gp::DY(), gp::DX()), 2);
  };
  struct Case {
    Handle(Geom_Curve) meridian;
    GeomAbs_SurfaceType type;
    double v0, v1;
  };
  const std::vector<Case> cases{{line(0, 1), GeomAbs_Cylinder, 1, 3},    {line(0, -1), GeomAbs_Cylinder, -1, 3},
                                {line(1, 1), GeomAbs_Cone, -1, 3},       {line(-1, 2), GeomAbs_Cone, 0, 3},
                                {line(1, -1), GeomAbs_Cone, 1, 2},       {circle(1, false), GeomAbs_Sphere, -1, 1},
                                {circle(1, true), GeomAbs_Sphere, 6, 7}, {circle(7, false), GeomAbs_Torus, 1, 4},
                                {circle(7, true), GeomAbs_Torus, -5, 0}};
  for (std::size_t i = 0; i < cases.size(); ++i)
    for (const gp_Ax1& axis : {up, down})
      for (const double turn : {1.0, 2 * pi})
        for (const bool reversed : {false, true}) {
          SCOPED_TRACE(std::to_string(i) + (reversed ? " reversed" : ""));
          const Case& c = cases[i];
          const TopoDS_Face swept =
              face(new Geom_SurfaceOfRevolution(c.meridian, axis), 0.5, 0.5 + turn, c.v0, c.v1, reversed);
          const TopoDS_Face found = TopoDS::Face(with_elementary_faces(swept));
          EXPECT_EQ(GeomAdaptor_Surface(BRep_Tool::Surface(found)).GetType(), c.type);
          EXPECT_TRUE(BRepCheck_Analyzer(found).IsValid());
          // What a face encloses with the origin has the sign of its side.
          EXPECT_NEAR(volume(found) / volume(swept), 1, 1e-5);
        }
}

TEST_F(ElementaryFaces, CirclesDrawnAlongTheirAxisAreCylinders) {
  for (const double z : {1.0, -1.0}) {
    const TopoDS_Face swept =
        face(new Geom_SurfaceOfLinearExtrusion(new Geom_Circle(gp_Ax2(gp_Pnt(1, 2, 3), gp::DZ()), 2), gp_Dir(0, 0, z)),
             0, 2 * pi, 1, 5, false);
    const TopoDS_Face found = TopoDS::Face(with_elementary_faces(swept));
    EXPECT_EQ(GeomAdaptor_Surface(BRep_Tool::Surface(found)).GetType(), GeomAbs_Cylinder);
    EXPECT_TRUE(BRepCheck_Analyzer(found).IsValid());
    EXPECT_NEAR(volume(found) / volume(swept), 1, 1e-5);
  }
}

TEST_F(ElementaryFaces, OthersStayAsTheyAre) {
  const gp_Ax1 axis(gp::Origin(), gp::DZ());
  const std::vector<Handle(Geom_Surface)> others{
      // A line that passes the axis sweeps a hyperboloid, a circle across its plane no torus.
      new Geom_SurfaceOfRevolution(new Geom_Line(gp_Pnt(3, 0, 0), gp_Dir(0, 1, 1)), axis),
      new Geom_SurfaceOfRevolution(new Geom_Circle(gp_Ax2(gp_Pnt(5, 0, 0), gp_Dir(0, 1, 1)), 2), axis),
      new Geom_SurfaceOfRevolution(new Geom_Ellipse(gp_Ax2(gp_Pnt(5, 0, 0), gp::DY()), 2, 1), axis),
      new Geom_SurfaceOfLinearExtrusion(new Geom_Circle(gp_Ax2(gp::Origin(), gp::DZ()), 2), gp_Dir(0, 1, 1))};
  for (const auto& surface : others) {
    const TopoDS_Face swept = face(surface, 0, 2, 0.2, 1, false);
    EXPECT_TRUE(with_elementary_faces(swept).IsSame(swept));
  }
}

TEST_F(ElementaryFaces, LatticesInABodyFromIges) {
  // What is in the cells and what is not are all of the body.
  const std::string file = iges(lathe(), false).string();
  double sum = 0;
  for (const char* operation : {"intersection", "difference"}) {
    const auto made = realised(
        "<macrostructures><macrostructure id='m'><import href='" + file +
        "'/></macrostructure></macrostructures><unitCells><unitCell id='u'><box dx='5' dy='5' dz='5'/><csg><union>"
        "<cylinder x1='-1' y1='2.5' z1='2.5' x2='6' y2='2.5' z2='2.5' radius='0.8'/><sphere x='2.5' y='2.5' z='2.5' "
        "radius='1.3'/></union></csg></unitCell></unitCells><patterns><pattern id='a' unitCell='u'><loop index='i' "
        "axis='x' count='4' start='-10' spacing='5'/><loop index='j' axis='y' count='4' start='-12' spacing='5'/><loop "
        "index='k' axis='z' count='4' start='-2' spacing='5'/></pattern></patterns>" +
        part(std::string("<apply pattern='a' operation='") + operation + "'/>"));
    ASSERT_TRUE(made) << operation;
    EXPECT_TRUE(audit(made->body).clean());
    sum += measure(made->body).volume;
  }
  EXPECT_NEAR(sum / lathe_volume, 1, 1e-5);
}

}  // namespace
}  // namespace meso::brep
