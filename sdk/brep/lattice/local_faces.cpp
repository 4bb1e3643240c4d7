// SPDX-License-Identifier: Apache-2.0
#include "lattice/local_faces.hpp"

#include <ElSLib.hxx>
#include <numbers>

#include "lattice/turned_spline.hpp"

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double margin = 0.1;          ///< of the cell, by which a patch exceeds it
constexpr double wide_margin = 0.5;     ///< of the cell, where the narrow one did not do
constexpr std::size_t many_edges = 12;  ///< from here on a window in the face is cheaper than the face
constexpr double long_edge = 4;         ///< diagonals of the cell
constexpr double steepest = 1.3;        ///< latitude of a patch on a sphere

/// A surface with parameters that are regular where the cell is.
struct LocalSurface {
  Handle(Geom_Surface) surface;
  bool turned = false;             ///< its parameters are not those of the face
  std::array<double, 2> period{};  ///< of the parameters, where points of one triangle may be told apart by one
  std::array<double, 2> around{};  ///< parameters are told within half a period of these
};

gp_Ax3 facing(const gp_Ax3& position, Vec3 at) {
  const gp_Vec to(position.Location(), to_pnt(at));
  const gp_Vec axis(position.Direction()), radial = to - to.Dot(axis) * axis;
  if (radial.Magnitude() < 1e-6) return position;
  // The parameter is pi where the cell is.
  gp_Ax3 out(position.Location(), position.Direction(), gp_Dir(-radial));
  if (!position.Direct()) out.YReverse();
  return out;
}

LocalSurface local_spline(const Handle(Geom_Surface) & surface, const std::array<double, 2>& at) {
  const auto spline = Handle(Geom_BSplineSurface)::DownCast(surface);
  const Handle(Geom_BSplineSurface) turned = spline.IsNull() ? spline : turned_to(spline, at);
  if (turned.IsNull()) return {surface};
  LocalSurface out{Handle(Geom_Surface)(turned), true};
  ParameterRange whole;
  turned->Bounds(whole.low[0], whole.high[0], whole.low[1], whole.high[1]);
  for (std::size_t i = 0; i < 2; ++i) {
    if (!(i == 0 ? spline->IsUClosed() : spline->IsVClosed())) continue;
    out.period[i] = whole.high[i] - whole.low[i];
    out.around[i] = 0.5 * (whole.low[i] + whole.high[i]);
  }
  return out;
}

/// About a point of space, and the parameters of a point of the surface near it.
LocalSurface local_surface(const TopoDS_Face& face, Vec3 at, const std::array<double, 2>& near) {
  const BRepAdaptor_Surface surface(face, false);
  switch (surface.GetType()) {
    case GeomAbs_Cylinder: {
      gp_Cylinder cylinder = surface.Cylinder();
      cylinder.SetPosition(facing(cylinder.Position(), at));
      return {new Geom_CylindricalSurface(cylinder), true, {2 * pi, 0}, {pi, 0}};
    }
    case GeomAbs_Cone: {
      gp_Cone cone = surface.Cone();
      cone.SetPosition(facing(cone.Position(), at));
      return {new Geom_ConicalSurface(cone), true, {2 * pi, 0}, {pi, 0}};
    }
    case GeomAbs_Torus: {
      gp_Torus torus = surface.Torus();
      torus.SetPosition(facing(torus.Position(), at));
      double u = 0, v = 0;
      ElSLib::Parameters(torus, to_pnt(at), u, v);
      return {new Geom_ToroidalSurface(torus), true, {2 * pi, 2 * pi}, {pi, v}};
    }
    case GeomAbs_Sphere: {
      gp_Sphere sphere = surface.Sphere();
      const gp_Vec to(sphere.Location(), to_pnt(at));
      if (to.Magnitude() < 1e-6) return {};
      const gp_Dir back(-to);
      gp_Ax3 position(sphere.Location(), gp_Ax2(sphere.Location(), back).XDirection(), back);
      if (!sphere.Position().Direct()) position.YReverse();
      sphere.SetPosition(position);
      return {new Geom_SphericalSurface(sphere), true, {2 * pi, 0}, {pi, 0}};
    }
    case GeomAbs_Plane:
      return {new Geom_Plane(surface.Plane())};
    default:
      return local_spline(BRep_Tool::Surface(face), near);
  }
}

/// Of a point of the surface, and `known` of the face.
std::array<double, 2> parameters_on(const LocalSurface& local, Vec3 p, const std::array<double, 2>& known) {
  const Handle(Geom_Surface)& surface = local.surface;
  std::array<double, 2> at = known;
  const gp_Pnt point = to_pnt(p);
  if (const auto cylinder = Handle(Geom_CylindricalSurface)::DownCast(surface))
    ElSLib::Parameters(cylinder->Cylinder(), point, at[0], at[1]);
  else if (const auto cone = Handle(Geom_ConicalSurface)::DownCast(surface))
    ElSLib::Parameters(cone->Cone(), point, at[0], at[1]);
  else if (const auto torus = Handle(Geom_ToroidalSurface)::DownCast(surface))
    ElSLib::Parameters(torus->Torus(), point, at[0], at[1]);
  else if (const auto sphere = Handle(Geom_SphericalSurface)::DownCast(surface))
    ElSLib::Parameters(sphere->Sphere(), point, at[0], at[1]);
  for (std::size_t i = 0; i < 2; ++i)
    if (local.period[i] > 0) at[i] = local.around[i] + std::remainder(at[i] - local.around[i], local.period[i]);
  return at;
}

/// The part of a B-spline surface over the range; other surfaces are as good as their trimming.
Handle(Geom_Surface) cut_out(const Handle(Geom_Surface) & surface, const ParameterRange& range) {
  const auto spline = Handle(Geom_BSplineSurface)::DownCast(surface);
  if (spline.IsNull()) return surface;
  const Handle(Geom_BSplineSurface) part = Handle(Geom_BSplineSurface)::DownCast(spline->Copy());
  part->Segment(range.low[0], range.high[0], range.low[1], range.high[1]);
  return Handle(Geom_Surface)(part);
}

/// The triangles near a cell as a rectangle of parameters. Empty where they wrap around.
template <typename Parameters, typename Wraps>
ParameterRange range_of_triangles(const BodySurface::Face& mesh, Vec3 centre, Vec3 grown, Parameters parameters,
                                  Wraps wraps) {
  ParameterRange range;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!overlaps(mesh.triangle(t), centre, grown)) continue;
    std::array<std::array<double, 2>, 3> at;
    for (std::size_t k = 0; k < 3; ++k) at[k] = parameters(mesh.triangles[t][k]);
    for (std::size_t k = 0; k < 3; ++k)
      if (wraps(at[k], at[(k + 1) % 3])) return {};
    for (const auto& p : at) range.extend(p);
  }
  range.grow(0.05);
  return range;
}

/// What of a plane can be in a box.
ParameterRange range_on_plane(const gp_Pln& plane, Vec3 centre, Vec3 grown) {
  ParameterRange range;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p = centre + Vec3{corner & 1 ? grown.x : -grown.x, corner & 2 ? grown.y : -grown.y,
                                 corner & 4 ? grown.z : -grown.z};
    std::array<double, 2> at{};
    ElSLib::Parameters(plane, to_pnt(p), at[0], at[1]);
    range.extend(at);
  }
  return range;
}

void keep_within(ParameterRange& range, const Geom_Surface& surface) {
  ParameterRange whole;
  surface.Bounds(whole.low[0], whole.high[0], whole.low[1], whole.high[1]);
  for (std::size_t i = 0; i < 2; ++i) {
    range.low[i] = std::fmax(range.low[i], whole.low[i]);
    range.high[i] = std::fmin(range.high[i], whole.high[i]);
  }
}

Vec3 grown_half(const CellGrid& grid, double reach, double share) {
  const Vec3 half = 0.5 * grid.size();
  const double by = reach + share * norm(half);
  return {half.x + by, half.y + by, half.z + by};
}

/// OpenCASCADE does not find where a long B-spline crosses a plane that it all but touches.
bool has_long_spline(const BodySurface::Face& mesh, const FaceEdges& face, double longest) {
  for (std::size_t e = 0; e < face.edges.size(); ++e) {
    if (BRepAdaptor_Curve(face.edges[e]).GetType() <= GeomAbs_Parabola) continue;
    double length = 0;
    const std::vector<std::uint32_t>& nodes = mesh.edges[e].nodes;
    for (std::size_t i = 0; i + 1 < nodes.size(); ++i) length += norm(mesh.nodes[nodes[i + 1]] - mesh.nodes[nodes[i]]);
    if (length > longest) return true;
  }
  return false;
}

}  // namespace

LocalFaces::LocalFaces(const BodySurface& surface, const CellGrid& grid) : surface_(surface), grid_(grid) {
  const TopoDS_Shape body = BRepBuilderAPI_Copy(surface.body()).Shape();
  std::uint32_t solid = 0;
  for (TopExp_Explorer one(body, TopAbs_SOLID); one.More(); one.Next(), ++solid)
    for (TopExp_Explorer it(one.Current(), TopAbs_FACE); it.More(); it.Next()) {
      FaceEdges& face = faces_.emplace_back(FaceEdges{TopoDS::Face(it.Current()), {}});
      for (TopExp_Explorer edge(face.face.Oriented(TopAbs_FORWARD), TopAbs_EDGE); edge.More(); edge.Next())
        if (!BRep_Tool::Degenerated(TopoDS::Edge(edge.Current()))) face.edges.push_back(TopoDS::Edge(edge.Current()));
      is_long_.push_back(has_long_spline(surface.face(static_cast<std::uint32_t>(solid_of_.size())), face,
                                         long_edge * norm(grid.size())));
      solid_of_.push_back(solid);
    }
}

LocalFaces::Near LocalFaces::near(const Index3& cell, const std::vector<std::uint32_t>& faces, bool patches) const {
  FaceWindows windows(grid_.tolerance);
  std::vector<TopoDS_Face> patched;
  for (const std::uint32_t number : faces) {
    patched.push_back(patches ? patch(number, cell) : TopoDS_Face());
    if (!patched.back().IsNull()) continue;
    const FaceEdges& face = faces_[number];
    const bool is_taken_whole = face.edges.size() < many_edges && (patches || !is_long_[number]);
    const ParameterRange range =
        is_taken_whole ? ParameterRange{} : window(number, cell, patches ? margin : wide_margin);
    if (range.empty())
      windows.add(face);
    else
      windows.add(face, surface_.face(number), range);
  }
  const std::vector<std::vector<TopoDS_Face>> others = windows.made();
  auto other = others.begin();
  Near out;
  const BRep_Builder builder;
  std::uint32_t last = 0;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (out.solids.empty() || solid_of_[faces[i]] != last) {
      TopoDS_Compound compound;
      builder.MakeCompound(compound);
      out.solids.push_back(compound);
      last = solid_of_[faces[i]];
    }
    for (const TopoDS_Face& face : patched[i].IsNull() ? *other++ : std::vector{patched[i]}) {
      builder.Add(out.solids.back(), face);
      out.stand_for.push_back(i);
    }
  }
  return out;
}

/// Of the face's own parameters; empty where there is none.
ParameterRange LocalFaces::window(std::uint32_t number, const Index3& cell, double share) const {
  const BodySurface::Face& mesh = surface_.face(number);
  const Vec3 grown = grown_half(grid_, mesh.reach, share);
  const BRepAdaptor_Surface surface(faces_[number].face, false);
  if (mesh.planar) return range_on_plane(surface.Plane(), grid_.centre(cell), grown);
  ParameterRange range = range_of_triangles(
      mesh, grid_.centre(cell), grown, [&](std::uint32_t node) { return mesh.parameters[node]; },
      [](const auto&, const auto&) { return false; });
  keep_within(range, *BRep_Tool::Surface(faces_[number].face));
  return range;
}

/// Null where an edge of the face is near, or where the parameters are not regular over the cell.
TopoDS_Face LocalFaces::patch(std::uint32_t number, const Index3& cell) const {
  const BodySurface::Face& mesh = surface_.face(number);
  const TopoDS_Face& face = faces_[number].face;
  const Vec3 centre = grid_.centre(cell), grown = grown_half(grid_, mesh.reach, margin);
  std::array<double, 2> near{};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (overlaps(mesh.triangle(t), centre, grown)) near = mesh.parameters[mesh.triangles[t][0]];
  const LocalSurface local = local_surface(face, centre, near);
  if (local.surface.IsNull()) return {};
  const auto parameters = [&](std::uint32_t node) {
    return local.turned ? parameters_on(local, mesh.nodes[node], mesh.parameters[node]) : mesh.parameters[node];
  };
  const auto wraps = [&](const std::array<double, 2>& p, const std::array<double, 2>& q) {
    return (local.period[0] > 0 && std::fabs(p[0] - q[0]) > local.period[0] / 2) ||
           (local.period[1] > 0 && std::fabs(p[1] - q[1]) > local.period[1] / 2);
  };
  ParameterRange range;
  if (mesh.planar) {
    range = range_on_plane(BRepAdaptor_Surface(face, false).Plane(), centre, grown);
  } else {
    range = range_of_triangles(mesh, centre, grown, parameters, wraps);
    if (!local.turned || !Handle(Geom_BSplineSurface)::DownCast(local.surface).IsNull())
      keep_within(range, *local.surface);
  }
  if (range.empty()) return {};
  if (!Handle(Geom_SphericalSurface)::DownCast(local.surface).IsNull() &&
      std::fmax(std::fabs(range.low[1]), std::fabs(range.high[1])) > steepest)
    return {};
  for (const BodySurface::Edge& edge : mesh.edges) {
    if (edge.seam && local.turned) continue;
    for (std::size_t i = 0; i + 1 < edge.nodes.size(); ++i) {
      const auto p = parameters(edge.nodes[i]), q = parameters(edge.nodes[i + 1]);
      if (!wraps(p, q) && range.meets(p, q)) return {};
    }
  }
  const Handle(Geom_Surface) part = cut_out(local.surface, range);
  BRepBuilderAPI_MakeFace made(part, range.low[0], range.high[0], range.low[1], range.high[1], Precision::Confusion());
  if (!made.IsDone()) return {};
  return TopoDS::Face(made.Face().Oriented(face.Orientation()));
}

}  // namespace meso::brep
