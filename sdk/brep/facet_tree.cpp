// SPDX-License-Identifier: Apache-2.0
#include "facet_tree.hpp"

#include <algorithm>
#include <array>

namespace meso::brep {
namespace {

Box3 box_of(const Triangle& t) {
  Box3 box;
  for (const Vec3 p : t) box.extend(p);
  return box;
}

Box3 grown(const Box3& box, double by) { return {box.min - Vec3{by, by, by}, box.max + Vec3{by, by, by}}; }

Box3 placed(const Box3& box, const Affine& map) {
  Box3 out;
  for (int i = 0; i < 8; ++i)
    out.extend(map * Vec3{(i & 1 ? box.max : box.min).x, (i & 2 ? box.max : box.min).y, (i & 4 ? box.max : box.min).z});
  return out;
}

double squared(Vec3 v) { return dot(v, v); }

double to_segment(Vec3 p, Vec3 a, Vec3 b) {
  const double length = squared(b - a);
  const double t = length > 0 ? std::clamp(dot(p - a, b - a) / length, 0.0, 1.0) : 0;
  return squared(a + t * (b - a) - p);
}

/// Squared, of a point from a triangle.
double to_triangle(Vec3 p, const Triangle& t) {
  const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
  const double area = squared(n);
  bool is_above = area > 0;
  for (std::size_t i = 0; is_above && i < 3; ++i) is_above = dot(cross(t[(i + 1) % 3] - t[i], p - t[i]), n) >= 0;
  if (is_above) {
    const double height = dot(p - t[0], n);
    return height * height / area;
  }
  return std::min({to_segment(p, t[0], t[1]), to_segment(p, t[1], t[2]), to_segment(p, t[2], t[0])});
}

/// Squared, of the inner points of two segments; where those are not nearest, points with segments are asked anyway.
double between_segments(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const Vec3 u = b - a, v = d - c, w = a - c;
  const double uu = squared(u), uv = dot(u, v), vv = squared(v), uw = dot(u, w), vw = dot(v, w);
  const double det = uu * vv - uv * uv;
  if (!(det > 1e-14 * uu * vv)) return HUGE_VAL;
  const double s = (uv * vw - vv * uw) / det, t = (uu * vw - uv * uw) / det;
  if (s < 0 || s > 1 || t < 0 || t > 1) return HUGE_VAL;
  return squared(w + s * u - t * v);
}

bool pierces(Vec3 a, Vec3 b, const Triangle& t) {
  const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
  const double at_a = dot(a - t[0], n), at_b = dot(b - t[0], n);
  if (at_a * at_b > 0 || at_a == at_b) return false;
  const Vec3 p = a + at_a / (at_a - at_b) * (b - a);
  for (std::size_t i = 0; i < 3; ++i)
    if (dot(cross(t[(i + 1) % 3] - t[i], p - t[i]), n) < 0) return false;
  return true;
}

bool are_within(double gap, const Triangle& s, const Triangle& t) {
  const double limit = gap * gap;
  for (std::size_t i = 0; i < 3; ++i)
    if (to_triangle(s[i], t) <= limit || to_triangle(t[i], s) <= limit) return true;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 a = s[i], b = s[(i + 1) % 3];
    if (pierces(a, b, t) || pierces(t[i], t[(i + 1) % 3], s)) return true;
    for (std::size_t k = 0; k < 3; ++k)
      if (between_segments(a, b, t[k], t[(k + 1) % 3]) <= limit) return true;
  }
  return false;
}

/// The corners of a face with one outline of three straight edges.
std::optional<Triangle> triangle_of(const TopoDS_Face& face) {
  std::vector<Vec3> corners;
  int wires = 0;
  for (TopoDS_Iterator wire(face); wire.More(); wire.Next()) {
    if (++wires > 1) return {};
    for (TopoDS_Iterator it(wire.Value()); it.More(); it.Next()) {
      if (corners.size() == 3) return {};
      // The first end of the edge as the outward face runs along it.
      const auto edge = TopoDS::Edge(it.Value());
      corners.push_back(to_vec(BRep_Tool::Pnt(TopExp::FirstVertex(edge, true))));
    }
  }
  if (corners.size() != 3) return {};
  const BRepAdaptor_Surface surface(face, false);
  const gp_Pln plane = surface.Plane();
  const Vec3 along = to_vec(plane.Axis().Direction()) * (plane.Direct() ? 1.0 : -1.0);
  const Vec3 outward = face.Orientation() == TopAbs_REVERSED ? -along : along;
  if (dot(cross(corners[1] - corners[0], corners[2] - corners[0]), outward) < 0) std::swap(corners[1], corners[2]);
  return Triangle{corners[0], corners[1], corners[2]};
}

bool is_flat(const TopoDS_Face& face) {
  if (BRepAdaptor_Surface(face, false).GetType() != GeomAbs_Plane) return false;
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next())
    if (BRepAdaptor_Curve(TopoDS::Edge(it.Current())).GetType() != GeomAbs_Line) return false;
  return true;
}

/// Between straight edges a mesh of a plane is the plane, whatever its deflection.
void add_meshed(const TopoDS_Face& face, std::vector<Triangle>& out) {
  const TopoDS_Shape copy = BRepBuilderAPI_Copy(face).Shape();  // the original may get a mesh of its own later
  BRepMesh_IncrementalMesh(copy, 1e6, false, 3);
  TopLoc_Location location;
  const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(TopoDS::Face(copy), location);
  if (mesh.IsNull()) throw Standard_Failure("a face cannot be triangulated");
  for (int i = 1; i <= mesh->NbTriangles(); ++i) {
    std::array<int, 3> n{};
    mesh->Triangle(i).Get(n[0], n[1], n[2]);
    if (copy.Orientation() == TopAbs_REVERSED) std::swap(n[1], n[2]);
    Triangle& t = out.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) t[k] = to_vec(mesh->Node(n[k]).Transformed(location.Transformation()));
  }
}

}  // namespace

std::optional<std::vector<Triangle>> facets_of(const Solids& solids) {
  for (const TopoDS_Shape& solid : solids)
    for (TopExp_Explorer it(solid, TopAbs_FACE); it.More(); it.Next())
      if (!is_flat(TopoDS::Face(it.Current()))) return {};
  std::vector<Triangle> out;
  for (const TopoDS_Shape& solid : solids)
    for (TopExp_Explorer it(solid, TopAbs_FACE); it.More(); it.Next()) {
      const TopoDS_Face& face = TopoDS::Face(it.Current());
      if (const auto triangle = triangle_of(face))
        out.push_back(*triangle);
      else
        add_meshed(face, out);
    }
  return out;
}

FacetTree::FacetTree(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
  nodes_.emplace_back();
  build(0, 0, triangles_.size());
}

void FacetTree::build(std::size_t node, std::size_t first, std::size_t last) {
  constexpr std::size_t leaf = 4;
  Box3 box;
  for (std::size_t i = first; i < last; ++i)
    for (const Vec3 p : triangles_[i]) box.extend(p);
  nodes_[node].box = box;
  if (last - first <= leaf) {
    nodes_[node].first = static_cast<std::uint32_t>(first);
    nodes_[node].count = static_cast<std::uint32_t>(last - first);
    return;
  }
  const Vec3 size = box.max - box.min;
  const std::size_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::size_t middle = (first + last) / 2;
  const auto at = [&](std::size_t i) { return triangles_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(first), at(middle), at(last), [axis](const Triangle& a, const Triangle& b) {
    return a[0][axis] + a[1][axis] + a[2][axis] < b[0][axis] + b[1][axis] + b[2][axis];
  });
  const std::size_t children = nodes_.size();
  nodes_[node].first = static_cast<std::uint32_t>(children);
  nodes_.resize(children + 2);
  build(children, first, middle);
  build(children + 1, middle, last);
}

/// Visits the triangles of the leaves that are near, until one says yes.
template <class Near, class Visit>
bool FacetTree::any_triangle(const Near& is_near, const Visit& visit) const {
  std::array<std::uint32_t, 64> open{};  // half as many triangles each level
  std::size_t count = 0;
  open[count++] = 0;
  while (count > 0) {
    const Node& node = nodes_[open[--count]];
    if (!is_near(node.box)) continue;
    for (std::uint32_t i = 0; i < node.count; ++i)
      if (visit(triangles_[node.first + i])) return true;
    if (node.count > 0) continue;
    open[count++] = node.first;
    open[count++] = node.first + 1;
  }
  return false;
}

bool FacetTree::is_within(double gap, Vec3 p) const {
  const Box3 around = grown({p, p}, gap);
  return any_triangle([&](const Box3& box) { return box.intersects(around); },
                      [&](const Triangle& t) { return to_triangle(p, t) <= gap * gap; });
}

bool FacetTree::is_within(double gap, const FacetTree& other, const Affine& this_from_other) const {
  // The leaves of the other one by one, from the root down as long as something of this is near.
  std::vector<std::uint32_t> open{0};
  while (!open.empty()) {
    const Node& node = other.nodes_[open.back()];
    open.pop_back();
    const Box3 around = grown(placed(node.box, this_from_other), gap);
    const auto is_near = [&](const Box3& box) { return box.intersects(around); };
    const auto meets = [&](const Triangle& t) { return box_of(t).intersects(around); };
    if (!any_triangle(is_near, meets)) continue;
    if (node.count == 0) {
      open.push_back(node.first);
      open.push_back(node.first + 1);
      continue;
    }
    for (std::uint32_t i = 0; i < node.count; ++i) {
      Triangle s = other.triangles_[node.first + i];
      for (Vec3& p : s) p = this_from_other * p;
      const Box3 near_s = grown(box_of(s), gap);
      if (any_triangle([&](const Box3& box) { return box.intersects(near_s); },
                       [&](const Triangle& t) { return box_of(t).intersects(near_s) && are_within(gap, s, t); }))
        return true;
    }
  }
  return false;
}

/// How often the ray leaves the body, less how often it enters; nothing if it comes too near an edge to tell.
std::optional<int> FacetTree::crossings(Vec3 p, Vec3 direction) const {
  const auto is_near = [&](const Box3& box) {
    double from = 0, to = HUGE_VAL;
    for (std::size_t i = 0; i < 3; ++i) {
      const double a = (box.min[i] - p[i]) / direction[i], b = (box.max[i] - p[i]) / direction[i];
      const double slack = 1e-12 * (std::fabs(a) + std::fabs(b));
      from = std::max(from, std::min(a, b) - slack);
      to = std::min(to, std::max(a, b) + slack);
    }
    return from <= to;
  };
  int sum = 0;
  const bool failed = any_triangle(is_near, [&](const Triangle& t) {
    const Vec3 a = t[0] - p, b = t[1] - p, c = t[2] - p;
    const std::array<double, 3> sides{dot(direction, cross(a, b)), dot(direction, cross(b, c)),
                                      dot(direction, cross(c, a))};
    const double scale = std::max({squared(a), squared(b), squared(c)});
    const auto [low, high] = std::ranges::minmax(sides);
    constexpr double doubt = 1e-13;
    if (low < -doubt * scale && high > doubt * scale) return false;  // passes by
    const double height = dot(a, cross(b, c));
    if (low <= doubt * scale && high >= -doubt * scale) return true;  // along an edge, or all of it seen edge on
    if (height != 0 && (height > 0) == (low > 0)) sum += low > 0 ? 1 : -1;
    return false;
  });
  return failed ? std::nullopt : std::optional(sum);
}

bool FacetTree::contains(Vec3 p) const {
  if (!box().intersects({p, p})) return false;
  // Oblique to everything that documents are made of; another one where that ray meets an edge.
  Vec3 direction{0.5773, 0.3114, 0.7548};
  for (int attempt = 0; attempt < 16; ++attempt) {
    if (const auto sum = crossings(p, direction)) return *sum != 0;
    direction = {direction.y + 0.1379, -direction.z, direction.x + 0.0731};
  }
  return false;
}

}  // namespace meso::brep
