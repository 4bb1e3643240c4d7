// SPDX-License-Identifier: Apache-2.0
#include "lattice/clip_signature.hpp"

#include <algorithm>

#include "lattice/box_overlap.hpp"

namespace meso::brep {
namespace {

constexpr int curve_points = 33;

std::int64_t rounded(double value, double quantum) { return std::llround(value / quantum); }

}  // namespace

ClipSignatures::ClipSignatures(const TopoDS_Shape& body, const CellGrid& grid) : grid_(grid) {
  const Vec3 size = grid.size();
  for (TopExp_Explorer it(body, TopAbs_FACE); it.More(); it.Next())
    faces_.push_back(read(TopoDS::Face(it.Current()), 0.1 * std::fmin(size.x, std::fmin(size.y, size.z))));
}

ClipSignatures::Face ClipSignatures::read(const TopoDS_Face& face, double curved_reach) {
  Face out;
  out.reversed = face.Orientation() == TopAbs_REVERSED;
  const BRepAdaptor_Surface surface(face);
  const auto mirrored = [&](const gp_Ax3& position) { out.reversed = out.reversed == position.Direct(); };
  const auto set = [&](Form form, const gp_Pnt& point, const gp_Ax1& axis, double a, double b) {
    out.shape = {form, to_vec(point), to_vec(axis.Direction()), a, b};
  };
  switch (surface.GetType()) {
    case GeomAbs_Plane:
      set(Form::plane, surface.Plane().Location(), surface.Plane().Axis(), 0, 0);
      mirrored(surface.Plane().Position());
      break;
    case GeomAbs_Cylinder:
      set(Form::cylinder, surface.Cylinder().Location(), surface.Cylinder().Axis(), surface.Cylinder().Radius(), 0);
      mirrored(surface.Cylinder().Position());
      break;
    case GeomAbs_Cone:
      set(Form::cone, surface.Cone().Apex(), surface.Cone().Axis(), surface.Cone().SemiAngle(), 0);
      mirrored(surface.Cone().Position());
      break;
    case GeomAbs_Sphere:
      set(Form::sphere, surface.Sphere().Location(), gp::OZ(), surface.Sphere().Radius(), 0);
      mirrored(surface.Sphere().Position());
      break;
    case GeomAbs_Torus:
      set(Form::torus, surface.Torus().Location(), surface.Torus().Axis(), surface.Torus().MajorRadius(),
          surface.Torus().MinorRadius());
      mirrored(surface.Torus().Position());
      break;
    default:
      break;
  }
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
    const TopoDS_Edge edge = TopoDS::Edge(it.Current());
    if (BRep_Tool::Degenerated(edge)) continue;
    const BRepAdaptor_Curve curve(edge);
    Edge value;
    const bool back = edge.Orientation() == TopAbs_REVERSED;
    value.from = to_vec(curve.Value(back ? curve.LastParameter() : curve.FirstParameter()));
    value.to = to_vec(curve.Value(back ? curve.FirstParameter() : curve.LastParameter()));
    if (curve.GetType() == GeomAbs_Line) {
      value.shape.form = Form::line;
      value.points = {value.from, value.to};
    } else {
      if (curve.GetType() == GeomAbs_Circle) {
        const gp_Circ circle = curve.Circle();
        value.shape = {Form::circle, to_vec(circle.Location()), (back ? -1.0 : 1.0) * to_vec(circle.Axis().Direction()),
                       circle.Radius(), 0};
      }
      double length = 0;
      for (int i = 0; i < curve_points; ++i) {
        const double t = static_cast<double>(i) / (curve_points - 1);
        value.points.push_back(to_vec(curve.Value((1 - t) * curve.FirstParameter() + t * curve.LastParameter())));
        if (i > 0) length = std::fmax(length, norm(value.points.back() - value.points[value.points.size() - 2]));
      }
      value.reach = 0.5 * length;  // no curve that matters strays further from its chord
    }
    out.edges.push_back(std::move(value));
    if (out.edges.back().reach > 0) out.reach = curved_reach;
  }
  if (out.shape.form != Form::plane) out.reach = curved_reach;
  return out;
}

void ClipSignatures::tell(Signature& to, Vec3 v) const {
  const Vec3 size = grid_.size();
  const double quantum = 1e-7 * std::fmin(size.x, std::fmin(size.y, size.z));
  for (std::size_t i = 0; i < 3; ++i) to.push_back(rounded(v[i], quantum));
}

void ClipSignatures::tell(Signature& to, const Shape& shape, std::int64_t number, const Index3& cell) const {
  const auto direction = [&](Vec3 v) {
    for (std::size_t i = 0; i < 3; ++i) to.push_back(rounded(v[i], 1e-9));
  };
  const Vec3 from = shape.point - grid_.centre(cell);  // of the cell
  to.push_back(static_cast<std::int64_t>(shape.form));
  switch (shape.form) {
    case Form::plane:
      direction(shape.axis);
      tell(to, dot(from, shape.axis) * shape.axis);
      break;
    case Form::cylinder:
      direction(shape.axis);
      tell(to, from - dot(from, shape.axis) * shape.axis);
      tell(to, {shape.a, 0, 0});
      break;
    case Form::cone:
      direction(shape.axis);
      tell(to, from);
      direction({shape.a, 0, 0});
      break;
    case Form::sphere:
    case Form::torus:
    case Form::circle:
      direction(shape.axis);
      tell(to, from);
      tell(to, {shape.a, shape.b, 0});
      break;
    case Form::line:
      break;
    case Form::other:
      to.push_back(number);
      for (const std::int32_t i : cell) to.push_back(i);
  }
}

ClipSignatures::Signature ClipSignatures::of(const Index3& cell, const std::vector<std::uint32_t>& faces) const {
  const Vec3 centre = grid_.centre(cell), half = 0.5 * grid_.size();
  const auto box_grown = [&](double by) { return Vec3{half.x + by, half.y + by, half.z + by}; };
  std::vector<Signature> told;
  for (const std::uint32_t number : faces) {
    const Face& face = faces_[number];
    std::vector<Signature> edges;
    for (std::size_t e = 0; e < face.edges.size(); ++e) {
      const Edge& edge = face.edges[e];
      for (std::size_t i = 0; i + 1 < edge.points.size(); ++i) {
        const double by = edge.reach + face.reach + grid_.tolerance;
        const auto part = clipped(edge.points[i], edge.points[i + 1], centre, box_grown(by));
        if (!part) continue;
        Signature& s = edges.emplace_back();
        tell(s, edge.shape, static_cast<std::int64_t>(e), cell);
        if (edge.shape.form == Form::line) {
          tell(s, part->first - centre);
          tell(s, part->second - centre);
        } else {
          tell(s, edge.from - centre);
          tell(s, edge.to - centre);
        }
        break;
      }
    }
    std::ranges::sort(edges);
    Signature& s = told.emplace_back();
    tell(s, face.shape, number, cell);
    s.push_back(face.reversed);
    for (const Signature& edge : edges) s.insert(s.end(), edge.begin(), edge.end());
  }
  std::ranges::sort(told);
  Signature all;
  for (const Signature& s : told) {
    all.push_back(static_cast<std::int64_t>(s.size()));
    all.insert(all.end(), s.begin(), s.end());
  }
  return all;
}

}  // namespace meso::brep
