// SPDX-License-Identifier: Apache-2.0
#include "in_memory.hpp"

#include <ElSLib.hxx>
#include <ShapeFix_Face.hxx>
#include <ShapeFix_Shape.hxx>
#include <ShapeFix_Shell.hxx>
#include <ShapeFix_Solid.hxx>
#include <ShapeFix_Wire.hxx>
#include <cmath>
#include <numbers>

#include "meso/brep/instance_map.hpp"
#include "meso/brep/placement.hpp"
#include "value_geometry.hpp"

namespace meso::brep {
namespace {

constexpr double tolerance = 1e-7;  // OpenCASCADE's own notion of the same point

enum class Mend { all, pcurves };

/// What a wire encloses on its left, by points; nothing where it goes around a pole.
std::optional<double> area_within(const TopoDS_Wire& wire, const gp_Sphere& sphere) {
  constexpr int parts = 16;
  const double pi = std::numbers::pi;
  double area = 0, around = 0;
  for (TopoDS_Iterator it(wire); it.More(); it.Next()) {
    const BRepAdaptor_Curve curve(TopoDS::Edge(it.Value()));
    const double first = curve.FirstParameter(), step = (curve.LastParameter() - first) / parts;
    const double way = it.Value().Orientation() == TopAbs_REVERSED ? -1 : 1;
    double u_before = 0, v_before = 0;
    for (int i = 0; i <= parts; ++i) {
      double u = 0, v = 0;
      ElSLib::Parameters(sphere, curve.Value(first + i * step), u, v);
      const double turn = std::remainder(u - u_before, 2 * pi);
      if (i > 0) {
        around += way * turn;
        area -= way * turn * (std::sin(v) + std::sin(v_before)) / 2;
      }
      u_before = u;
      v_before = v;
    }
  }
  if (std::fabs(around) > pi) return {};
  return area * sphere.Radius() * sphere.Radius();
}

class ShellAssembler {
 public:
  ShellAssembler(const Shell& shell, Mend mend) : shell_(shell), template_(*shell.geometry), mend_(mend) {}

  TopoDS_Shell assemble() {
    TopoDS_Shell result;
    builder_.MakeShell(result);
    shell_.visit([&](const FaceInstance& instance) {
      builder_.Add(result, make_face(template_.faces[instance.face], instance.cell));
    });
    result.Closed(Standard_True);
    return result;
  }

 private:
  // Add() complements children of a reversed parent: the face stays forward until it is whole.
  TopoDS_Face make_face(const FaceTemplate& face, const Index3& cell) {
    TopoDS_Face result;
    const Handle(Geom_Surface) surface = to_geom(face.surface);
    surface->Transform(placed(cell));
    builder_.MakeFace(result, surface, tolerance);
    for (const auto& loop : face.loops) {
      TopoDS_Wire wire;
      builder_.MakeWire(wire);
      for (const Coedge& use : loop)
        if (!template_.edges[use.edge].degenerate)  // the fixer adds those, with their pcurves
          builder_.Add(wire, edge(use.edge, cell + use.offset)
                                 .Oriented(use.reversed != face.reversed ? TopAbs_REVERSED : TopAbs_FORWARD));
      wire.Closed(Standard_True);
      if (TopoDS_Iterator(wire).More()) builder_.Add(result, wire);
    }
    if (mend_ == Mend::pcurves && has_poles_within(face, surface, result, placed(cell).ScaleFactor()))
      add_natural_bound(result, surface);
    if (face.reversed) result.Reverse();
    return result;
  }

  /// Is all that bounds it a hole in a ball, for OpenCASCADE?
  static bool has_poles_within(const FaceTemplate& face, const Handle(Geom_Surface) & surface,
                               const TopoDS_Face& forward, double scale) {
    const Handle(Geom_SphericalSurface) ball = Handle(Geom_SphericalSurface)::DownCast(surface);
    if (ball.IsNull() || !TopoDS_Iterator(forward).More() || face.moments.area <= 0) return false;
    double within = 0;
    for (TopoDS_Iterator it(forward); it.More(); it.Next()) {
      const auto area = area_within(TopoDS::Wire(it.Value()), ball->Sphere());
      if (!area) return false;
      within += *area;
    }
    const double area = face.moments.area * scale * scale, all = ball->Area();
    return std::fabs(area - within - all) < std::fabs(area - within);
  }

  void add_natural_bound(TopoDS_Face& face, const Handle(Geom_Surface) & surface) const {
    const BRepBuilderAPI_MakeFace whole(surface, tolerance);
    TopoDS_Face bounded;
    builder_.MakeFace(bounded, surface, tolerance);
    // The same surface: pcurves of the natural bound go on being its own.
    for (const TopoDS_Shape& from : {TopoDS_Shape(whole.Face()), TopoDS_Shape(face)})
      for (TopoDS_Iterator it(from); it.More(); it.Next()) builder_.Add(bounded, it.Value());
    face = bounded;
  }

  TopoDS_Edge edge(std::uint32_t index, const Index3& cell) {
    const auto [known, fresh] = edges_.find_or_add(index, cell);
    if (!fresh) return edge_shapes_[known];
    known = static_cast<std::uint32_t>(edge_shapes_.size());
    const EdgeTemplate& e = template_.edges[index];
    const Vec3 from = template_.vertices[e.vertex[0]] + cell_origin(template_, e.vertex_offset[0]);
    const Vec3 to = template_.vertices[e.vertex[1]] + cell_origin(template_, e.vertex_offset[1]);
    const bool closed = e.vertex[0] == e.vertex[1] && e.vertex_offset[0] == e.vertex_offset[1];
    const CurveRange range = range_between(e.curve, from, to, closed);
    const double scale = placed(cell).ScaleFactor();
    const bool by_length = std::holds_alternative<Line>(e.curve);  // the only curve whose parameter is a length
    const Handle(Geom_Curve) curve = to_geom(e.curve);
    curve->Transform(placed(cell));
    TopoDS_Edge result;
    builder_.MakeEdge(result, curve, tolerance);
    builder_.Add(result, vertex(e.vertex[0], cell + e.vertex_offset[0]).Oriented(TopAbs_FORWARD));
    builder_.Add(result, vertex(e.vertex[1], cell + e.vertex_offset[1]).Oriented(TopAbs_REVERSED));
    builder_.Range(result, range.first * (by_length ? scale : 1), range.last * (by_length ? scale : 1));
    edge_shapes_.push_back(result);
    return result;
  }

  TopoDS_Vertex vertex(std::uint32_t index, const Index3& cell) {
    const auto [known, fresh] = vertices_.find_or_add(index, cell);
    if (!fresh) return vertex_shapes_[known];
    known = static_cast<std::uint32_t>(vertex_shapes_.size());
    TopoDS_Vertex result;
    builder_.MakeVertex(result, to_pnt(template_.vertices[index]).Transformed(placed(cell)), tolerance);
    vertex_shapes_.push_back(result);
    return result;
  }

  [[nodiscard]] gp_Trsf placed(const Index3& cell) const {
    const Mat3& m = shell_.placement.linear;
    const Vec3 t = shell_.placement * cell_origin(template_, cell);
    gp_Trsf result;
    result.SetValues(m(0, 0), m(0, 1), m(0, 2), t.x, m(1, 0), m(1, 1), m(1, 2), t.y, m(2, 0), m(2, 1), m(2, 2), t.z);
    return result;
  }

  const Shell& shell_;
  const Template& template_;
  Mend mend_;
  BRep_Builder builder_;
  InstanceMap<std::uint32_t> vertices_, edges_;
  std::vector<TopoDS_Vertex> vertex_shapes_;
  std::vector<TopoDS_Edge> edge_shapes_;
};

/// What would divide edges that touch, or take out those that are short.
void leave_edges(ShapeFix_Shape& fix) {
  const Handle(ShapeFix_Face) face = fix.FixFaceTool();
  const Handle(ShapeFix_Wire) wire = fix.FixWireTool();
  fix.FixSolidTool()->FixShellOrientationMode() = 0;
  fix.FixShellTool()->FixOrientationMode() = 0;
  for (Standard_Integer* mode :
       {&face->FixOrientationMode(), &face->FixAddNaturalBoundMode(), &face->FixSmallAreaWireMode(),
        &face->RemoveSmallAreaFaceMode(), &face->FixIntersectingWiresMode(), &face->FixLoopWiresMode(),
        &face->FixSplitFaceMode(), &wire->FixReorderMode(), &wire->FixSmallMode(), &wire->FixSelfIntersectionMode(),
        &wire->FixLackingMode(), &wire->FixNotchedEdgesMode(), &wire->FixSelfIntersectingEdgeMode(),
        &wire->FixIntersectingEdgesMode(), &wire->FixNonAdjacentIntersectingEdgesMode(), &wire->FixTailMode()})
    *mode = 0;
}

TopoDS_Shape assemble(const Solid& solid, Mend mend) {
  BRep_Builder builder;
  TopoDS_Solid result;
  builder.MakeSolid(result);
  builder.Add(result, ShellAssembler(solid.outer, mend).assemble());
  for (const Shell& hollow : solid.voids) builder.Add(result, ShellAssembler(hollow, mend).assemble());
  ShapeFix_Shape fix(result);  // projects pcurves, adds seams and degenerate edges as the STEP reader does
  if (mend == Mend::pcurves) leave_edges(fix);
  fix.Perform();
  return fix.Shape();
}

std::optional<TopoDS_Shape> to_shape(const Body& body, Mend mend, DiagnosticSink& sink) {
  try {
    if (body.solids.size() == 1) return assemble(body.solids[0], mend);
    BRep_Builder builder;
    TopoDS_Compound all;
    builder.MakeCompound(all);
    for (const Solid& solid : body.solids) builder.Add(all, assemble(solid, mend));
    return all;
  } catch (const Standard_Failure& failure) {
    sink.report({.code = Code::geometry_kernel, .args = {"building a shape", what(failure)}});
    return std::nullopt;
  }
}

}  // namespace

std::optional<TopoDS_Shape> to_shape(const Body& body, DiagnosticSink& sink) { return to_shape(body, Mend::all, sink); }

std::optional<TopoDS_Shape> to_shape_as_is(const Body& body, DiagnosticSink& sink) {
  return to_shape(body, Mend::pcurves, sink);
}

}  // namespace meso::brep
