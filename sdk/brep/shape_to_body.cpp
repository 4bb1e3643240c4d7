// SPDX-License-Identifier: Apache-2.0
#include "shape_to_body.hpp"

#include <ShapeFix_Wire.hxx>
#include <map>

#include "face_mesh.hpp"
#include "face_moments.hpp"
#include "geometry_values.hpp"
#include "meso/brep/placement.hpp"

namespace meso::brep {
namespace {

class TemplateBuilder {
 public:
  Template build(const TopoDS_Shell& shell, const std::optional<MeshTolerance>& mesh) {
    TopExp::MapShapes(shell, TopAbs_VERTEX, vertices_);
    TopExp::MapShapes(shell, TopAbs_EDGE, edges_);
    for (int i = 1; i <= vertices_.Extent(); ++i)
      template_.vertices.push_back(to_vec(BRep_Tool::Pnt(TopoDS::Vertex(vertices_(i)))));
    for (int i = 1; i <= edges_.Extent(); ++i)
      template_.edges.push_back(to_edge(TopoDS::Edge(edges_(i).Oriented(TopAbs_FORWARD))));
    for (TopExp_Explorer it(shell, TopAbs_FACE); it.More(); it.Next())
      template_.faces.push_back(to_face(TopoDS::Face(it.Current())));
    if (mesh) mesh_faces(shell, *mesh, edges_, vertices_, template_);
    return std::move(template_);
  }

 private:
  [[nodiscard]] std::uint32_t vertex_index(const TopoDS_Vertex& vertex) const {
    return static_cast<std::uint32_t>(vertices_.FindIndex(vertex) - 1);
  }

  [[nodiscard]] EdgeTemplate to_edge(const TopoDS_Edge& edge) const {
    const TopoDS_Vertex first = TopExp::FirstVertex(edge), last = TopExp::LastVertex(edge);
    if (first.IsNull() || last.IsNull()) throw Standard_Failure("an edge without end points");
    EdgeTemplate value{.curve = Line{}, .vertex = {vertex_index(first), vertex_index(last)}};
    value.degenerate = BRep_Tool::Degenerated(edge);
    if (value.degenerate) return value;
    double begin = 0, end = 0;
    Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, begin, end);
    if (curve.IsNull() && BRepLib::BuildCurve3d(edge)) curve = BRep_Tool::Curve(edge, begin, end);
    if (curve.IsNull()) throw Standard_Failure("an edge without a curve");
    value.curve = to_curve(curve, begin, end);
    return value;
  }

  [[nodiscard]] FaceTemplate to_face(const TopoDS_Face& face) const {
    UvBounds uv;
    BRepTools::UVBounds(face, uv.u_min, uv.u_max, uv.v_min, uv.v_max);
    const SurfaceValue surface = to_surface(BRep_Tool::Surface(face), uv);
    const bool against_du_dv = face.Orientation() == TopAbs_REVERSED;
    FaceTemplate value{.surface = surface.surface, .reversed = against_du_dv != surface.flipped};
    const TopoDS_Face forward = TopoDS::Face(face.Oriented(TopAbs_FORWARD));
    const TopoDS_Wire outer = BRepTools::OuterWire(forward);
    if (!outer.IsNull()) value.loops.push_back(to_loop(outer, forward, against_du_dv));
    for (TopoDS_Iterator it(forward); it.More(); it.Next()) {
      if (it.Value().ShapeType() != TopAbs_WIRE || it.Value().IsSame(outer)) continue;
      auto loop = to_loop(TopoDS::Wire(it.Value()), forward, against_du_dv);
      // A line along which another face touches this one bounds nothing.
      if (!loop.empty()) value.loops.push_back(std::move(loop));
    }
    value.moments = face_moments(face);
    value.box = face_box(face);
    return value;
  }

  // The edges in order. On a forward face loops are counter-clockwise about du x dv; a reversed face turns them over.
  [[nodiscard]] std::vector<Coedge> to_loop(const TopoDS_Wire& wire, const TopoDS_Face& forward, bool reverse) const {
    std::vector<TopoDS_Edge> chain;
    for (TopoDS_Iterator it(wire); it.More(); it.Next())
      if (it.Value().Orientation() == TopAbs_FORWARD || it.Value().Orientation() == TopAbs_REVERSED)
        chain.push_back(TopoDS::Edge(it.Value()));
    const std::size_t count = chain.size();
    if (count > 1) {  // the explorer looks at the whole face, which may have a thousand circles
      chain.clear();
      for (BRepTools_WireExplorer it(wire, forward); it.More(); it.Next()) chain.push_back(it.Current());
    }
    if (chain.size() != count)
      chain = reordered(wire, forward);  // the explorer stops where a vertex has several ways on
    std::vector<Coedge> loop;
    for (const TopoDS_Edge& edge : chain)
      loop.push_back({.edge = static_cast<std::uint32_t>(edges_.FindIndex(edge) - 1),
                      .reversed = (edge.Orientation() == TopAbs_REVERSED) != reverse});
    if (reverse) std::reverse(loop.begin(), loop.end());
    return loop;
  }

  static std::vector<TopoDS_Edge> reordered(const TopoDS_Wire& wire, const TopoDS_Face& forward) {
    ShapeFix_Wire fix(wire, forward, 1e-6);
    fix.FixReorder();
    std::vector<TopoDS_Edge> chain;
    for (int i = 1; i <= fix.WireData()->NbEdges(); ++i) chain.push_back(fix.WireData()->Edge(i));
    return chain;
  }

  TopTools_IndexedMapOfShape vertices_, edges_;
  Template template_;
};

Affine to_affine(const gp_Trsf& t) {
  Affine a;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      a.linear(static_cast<std::size_t>(row), static_cast<std::size_t>(column)) = t.Value(row + 1, column + 1);
    a.translation[static_cast<std::size_t>(row)] = t.Value(row + 1, 4);
  }
  return a;
}

double signed_volume(const Template& geometry) {
  double volume = 0;
  for (const FaceTemplate& face : geometry.faces)
    volume += face.moments.volume_moment.x + face.moments.volume_moment.y + face.moments.volume_moment.z;
  return volume / 3;
}

class BodyBuilder {
 public:
  BodyBuilder(const ShapeToBodyOptions& options, DiagnosticSink& sink) : options_(options), sink_(sink) {}

  std::optional<Body> build(const TopoDS_Shape& shape) {
    for (TopExp_Explorer it(shape, TopAbs_SOLID); it.More(); it.Next()) add_solid(TopoDS::Solid(it.Current()));
    if (body_.solids.empty() && !sink_.has_errors()) sink_.report({.code = Code::geometry_no_solid});
    if (sink_.has_errors()) return std::nullopt;
    return std::move(body_);
  }

 private:
  // The outer shell is the one that encloses material; every other one encloses a hole in it.
  void add_solid(const TopoDS_Solid& solid) {
    Solid value;
    int outer_shells = 0;
    for (TopExp_Explorer it(solid, TopAbs_SHELL); it.More(); it.Next()) {
      const auto& [shell, volume] = to_shell(TopoDS::Shell(it.Current()));
      if (volume > 0) {
        value.outer = shell;
        ++outer_shells;
      } else {
        value.voids.push_back(shell);
      }
    }
    if (outer_shells == 1)
      body_.solids.push_back(std::move(value));
    else
      sink_.report({.code = Code::geometry_outer_shells, .args = {std::to_string(outer_shells)}});
  }

  struct ShellVolume {
    Shell shell;
    double volume = 0;
  };

  ShellVolume to_shell(const TopoDS_Shell& placed) {
    const gp_Trsf location = placed.Location().Transformation();
    if (location.IsNegative()) {  // a placement is never a mirror image: the geometry is
      BRepBuilderAPI_Transform baked(placed.Located(TopLoc_Location()), location, Standard_True);
      return make_shell(TopoDS::Shell(baked.Shape()), {});
    }
    return make_shell(TopoDS::Shell(placed.Located(TopLoc_Location())), to_affine(location));
  }

  ShellVolume make_shell(const TopoDS_Shell& shell, const Affine& placement) {
    const auto key = std::pair(shell.TShape().get(), shell.Orientation());
    auto known = templates_.find(key);
    if (known == templates_.end()) {
      auto geometry = std::make_shared<const Template>(shell_to_template(shell, options_.mesh));
      const double volume = signed_volume(*geometry);
      known = templates_.emplace(key, Known{shell, std::move(geometry), volume}).first;
    }
    return {whole_template(known->second.geometry, placement), known->second.volume};
  }

  struct Known {
    TopoDS_Shell keeps_alive;  // the key is its address
    std::shared_ptr<const Template> geometry;
    double volume = 0;
  };
  const ShapeToBodyOptions& options_;
  DiagnosticSink& sink_;
  Body body_;
  std::map<std::pair<const TopoDS_TShape*, TopAbs_Orientation>, Known> templates_;
};

}  // namespace

Template shell_to_template(const TopoDS_Shell& shell, const std::optional<MeshTolerance>& mesh) {
  return TemplateBuilder().build(TopoDS::Shell(shell.Located(TopLoc_Location())), mesh);
}

std::optional<Body> shape_to_body(const TopoDS_Shape& shape, const ShapeToBodyOptions& options, DiagnosticSink& sink) {
  try {
    return BodyBuilder(options, sink).build(shape);
  } catch (const Standard_Failure& failure) {
    sink.report({.code = Code::geometry_kernel, .args = {"reading a shape", what(failure)}});
    return std::nullopt;
  }
}

}  // namespace meso::brep
