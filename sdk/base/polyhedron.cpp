// SPDX-License-Identifier: Apache-2.0
#include "meso/base/polyhedron.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "meso/base/faces_cross.hpp"

namespace meso {
namespace {

using Fault = std::optional<PolyhedronFault>;
using Face = std::vector<std::size_t>;

std::string to_three_digits(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 3).ptr;
  return {text.data(), end};
}

double size_of(const Polyhedron& p) {
  Box3 box;
  for (const Vec3 v : p.vertices) box.extend(v);
  return norm(box.max - box.min);
}

/// Twice the face's area along its normal (Newell); about the first corner, so that far bodies lose no digits.
Vec3 area_vector(const Polyhedron& p, const Face& face) {
  Vec3 sum;
  const Vec3 origin = p.vertices[face.front()];
  for (std::size_t i = 1; i + 1 < face.size(); ++i)
    sum += cross(p.vertices[face[i]] - origin, p.vertices[face[i + 1]] - origin);
  return sum;
}

/// The coordinate that a projection leaves out.
std::size_t steepest(Vec3 n) {
  const double x = std::fabs(n.x), y = std::fabs(n.y), z = std::fabs(n.z);
  return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

Point2 seen_along(std::size_t axis, Vec3 p) { return {p[(axis + 1) % 3], p[(axis + 2) % 3]}; }

std::vector<Point2> seen_along(std::size_t axis, const Polyhedron& p, const Face& face) {
  std::vector<Point2> corners;
  for (const std::size_t v : face) corners.push_back(seen_along(axis, p.vertices[v]));
  return corners;
}

Fault face_fault(const Polyhedron& p, std::size_t f, double size) {
  const Face& face = p.faces[f];
  const auto fault = [&](Code code, std::string words) { return PolyhedronFault{code, f, {std::move(words)}}; };
  for (std::size_t i = 0; i < face.size(); ++i) {
    if (face[i] >= p.vertices.size())
      return fault(Code::polyhedron_index, "vertex " + std::to_string(face[i]) + ", but there are only " +
                                               std::to_string(p.vertices.size()) + ", counted from 0");
    if (std::find(face.begin(), face.begin() + static_cast<std::ptrdiff_t>(i), face[i]) !=
        face.begin() + static_cast<std::ptrdiff_t>(i))
      return fault(Code::polyhedron_index, "vertex " + std::to_string(face[i]) + " twice");
  }
  if (face.size() < 3) return fault(Code::polyhedron_face, "has fewer than three corners");
  const double area = norm(area_vector(p, face));
  if (!(area > polyhedron_flatness * polyhedron_flatness * size * size))
    return fault(Code::polyhedron_face, "has no area");
  const FacePlane plane = plane_of(p, f);
  for (const std::size_t v : face) {
    const double off = std::fabs(dot(plane.normal, p.vertices[v]) - plane.offset);
    if (!(off <= polyhedron_flatness * size))
      return fault(Code::polyhedron_face,
                   "is not plane: vertex " + std::to_string(v) + " is " + to_three_digits(off) + " off");
  }
  if (auto words = polygon_fault(flattened(p, f), 0)) return fault(Code::polyhedron_face, std::move(*words));
  return {};
}

using Edge = std::pair<std::size_t, std::size_t>;
/// Each directed edge and the faces that run along it.
std::map<Edge, Face> directed_edges(const Polyhedron& p) {
  std::map<Edge, Face> edges;
  for (std::size_t f = 0; f < p.faces.size(); ++f)
    for (std::size_t i = 0; i < p.faces[f].size(); ++i)
      edges[{p.faces[f][i], p.faces[f][(i + 1) % p.faces[f].size()]}].push_back(f);
  return edges;
}

Fault open_edge(const Polyhedron& p) {
  const auto edges = directed_edges(p);
  const auto fault = [](std::size_t face, Edge e, std::string words) {
    return PolyhedronFault{
        Code::polyhedron_not_closed, face, {std::to_string(e.first), std::to_string(e.second), std::move(words)}};
  };
  for (std::size_t f = 0; f < p.faces.size(); ++f)
    for (std::size_t i = 0; i < p.faces[f].size(); ++i) {
      const Edge edge{p.faces[f][i], p.faces[f][(i + 1) % p.faces[f].size()]};
      const auto back = edges.find({edge.second, edge.first});
      if (edges.at(edge).size() > 1)
        return fault(edges.at(edge)[1], edge, "is run along in this direction by another face too");
      if (back == edges.end()) return fault(f, edge, "belongs to this face alone");
    }
  return {};
}

/// Where the closed segment ab meets the closed face, though it does not share what they have in common.
class Crossing {
 public:
  Crossing(const Polyhedron& p, std::size_t face, double tolerance)
      : p_(p),
        face_(p.faces[face]),
        plane_(plane_of(p, face)),
        axis_(steepest(plane_.normal)),
        corners_(seen_along(axis_, p, face_)),
        tolerance_(tolerance) {}

  [[nodiscard]] bool meets(Edge edge) const {
    const bool has_a = has(edge.first), has_b = has(edge.second);
    if (has_a && has_b && neighbours(edge)) return false;
    const Vec3 a = p_.vertices[edge.first], b = p_.vertices[edge.second];
    const double da = height(a), db = height(b);
    const bool flat_a = has_a || std::fabs(da) <= tolerance_, flat_b = has_b || std::fabs(db) <= tolerance_;
    if (flat_a && flat_b) return meets_in_plane(edge);
    if (has_a || has_b || (!flat_a && !flat_b && (da > 0) == (db > 0))) return false;
    const Vec3 hit = flat_a ? a : flat_b ? b : a + (da / (da - db)) * (b - a);
    return in_polygon(corners_, seen_along(axis_, hit));
  }

 private:
  [[nodiscard]] bool has(std::size_t v) const { return std::find(face_.begin(), face_.end(), v) != face_.end(); }
  [[nodiscard]] bool neighbours(Edge e) const {
    for (std::size_t i = 0; i < face_.size(); ++i) {
      const std::size_t u = face_[i], v = face_[(i + 1) % face_.size()];
      if ((u == e.first && v == e.second) || (u == e.second && v == e.first)) return true;
    }
    return false;
  }
  [[nodiscard]] double height(Vec3 q) const { return dot(plane_.normal, q) - plane_.offset; }

  [[nodiscard]] bool meets_in_plane(Edge edge) const {
    const Point2 a = seen_along(axis_, p_.vertices[edge.first]), b = seen_along(axis_, p_.vertices[edge.second]);
    for (std::size_t i = 0; i < face_.size(); ++i) {
      const std::size_t u = face_[i], v = face_[(i + 1) % face_.size()];
      const bool shares = u == edge.first || u == edge.second || v == edge.first || v == edge.second;
      if (!shares && segments_meet(a, b, corners_[i], corners_[(i + 1) % face_.size()])) return true;
    }
    return in_polygon(corners_, {(a.first + b.first) / 2, (a.second + b.second) / 2});
  }

  const Polyhedron& p_;
  const Face& face_;
  FacePlane plane_;
  std::size_t axis_;
  std::vector<Point2> corners_;
  double tolerance_;
};

}  // namespace

bool faces_cross(const Polyhedron& p, std::size_t f, std::size_t g, double tolerance) {
  const auto edges_meet = [&](std::size_t face, std::size_t other) {
    const Crossing test(p, face, tolerance);
    const Face& corners = p.faces[other];
    for (std::size_t i = 0; i < corners.size(); ++i)
      if (test.meets({corners[i], corners[(i + 1) % corners.size()]})) return true;
    return false;
  };
  return edges_meet(f, g) || edges_meet(g, f);
}

namespace {

Fault crossing(const Polyhedron& p, double size) {
  const double tolerance = polyhedron_flatness * size;
  const Vec3 room{tolerance, tolerance, tolerance};
  const auto box_of = [&](const Face& face) {
    Box3 box;
    for (const std::size_t v : face) box.extend(p.vertices[v]);
    return Box3{box.min - room, box.max + room};
  };
  std::vector<Box3> boxes;
  for (const Face& face : p.faces) boxes.push_back(box_of(face));
  std::vector<std::size_t> order(p.faces.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return boxes[a].min.x < boxes[b].min.x; });
  Fault first;
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size() && boxes[order[j]].min.x <= boxes[order[i]].max.x; ++j) {
      const auto [f, g] = std::minmax(order[i], order[j]);
      if ((first && first->face <= f) || !boxes[f].intersects(boxes[g]) || !faces_cross(p, f, g, tolerance)) continue;
      std::string words;
      for (const std::size_t v : p.faces[g]) words += (words.empty() ? "" : ", ") + std::to_string(v);
      first = {Code::polyhedron_crosses, f, {words}};
    }
  return first;
}

/// Outer shells go round nothing else; walls of cavities are within one.
Fault turned_shell(const Polyhedron& p) {
  const std::vector<std::size_t> shell = shells_of(p);
  const std::size_t count = *std::max_element(shell.begin(), shell.end()) + 1;
  for (std::size_t s = 0; s < count; ++s) {
    Face own, others;
    for (std::size_t f = 0; f < shell.size(); ++f) (shell[f] == s ? own : others).push_back(f);
    const Face& first = p.faces[own.front()];
    const Vec3 middle = 0.5 * (p.vertices[first[0]] + p.vertices[first[1]]);
    const double round = std::round(winding_of(p, others, middle));
    if (volume_of(p, own) > 0 ? round != 0 : round != 1)
      return PolyhedronFault{Code::polyhedron_inside_out, own.front(), {}};
  }
  return {};
}

}  // namespace

FacePlane plane_of(const Polyhedron& p, std::size_t f) {
  const Face& face = p.faces[f];
  const Vec3 area = area_vector(p, face), normal = area / norm(area);
  double sum = 0;
  for (const std::size_t v : face) sum += dot(normal, p.vertices[v]);
  return {normal, sum / static_cast<double>(face.size())};
}

std::vector<Point2> flattened(const Polyhedron& p, std::size_t face) {
  return seen_along(steepest(area_vector(p, p.faces[face])), p, p.faces[face]);
}

std::vector<std::size_t> shells_of(const Polyhedron& p) {
  const auto edges = directed_edges(p);
  constexpr auto none = static_cast<std::size_t>(-1);
  std::vector<std::size_t> shell(p.faces.size(), none);
  std::size_t count = 0;
  for (std::size_t start = 0; start < p.faces.size(); ++start) {
    if (shell[start] != none) continue;
    Face open{start};
    shell[start] = count;
    while (!open.empty()) {
      const Face& face = p.faces[open.back()];
      open.pop_back();
      for (std::size_t i = 0; i < face.size(); ++i)
        for (const std::size_t next : edges.at({face[(i + 1) % face.size()], face[i]})) {
          if (shell[next] != none) continue;
          shell[next] = count;
          open.push_back(next);
        }
    }
    ++count;
  }
  return shell;
}

double volume_of(const Polyhedron& p, const std::vector<std::size_t>& faces) {
  const Vec3 origin = p.vertices[p.faces[faces.front()].front()];
  double sum = 0;
  for (const std::size_t f : faces) sum += dot(p.vertices[p.faces[f].front()] - origin, area_vector(p, p.faces[f]));
  return sum / 6;
}

double winding_of(const Polyhedron& p, const std::vector<std::size_t>& faces, Vec3 q) {
  double angle = 0;  // A. van Oosterom and J. Strackee, The solid angle of a plane triangle, 1983
  for (const std::size_t f : faces) {
    const Face& face = p.faces[f];
    const Vec3 a = p.vertices[face[0]] - q;
    for (std::size_t i = 1; i + 1 < face.size(); ++i) {
      const Vec3 b = p.vertices[face[i]] - q, c = p.vertices[face[i + 1]] - q;
      const double la = norm(a), lb = norm(b), lc = norm(c);
      angle += 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
    }
  }
  return angle / (4 * std::numbers::pi);
}

Fault polyhedron_fault(const Polyhedron& p) {
  const double size = size_of(p);
  for (std::size_t f = 0; f < p.faces.size(); ++f)
    if (auto fault = face_fault(p, f, size)) return fault;
  if (auto fault = open_edge(p)) return fault;
  if (auto fault = crossing(p, size)) return fault;
  return turned_shell(p);
}

}  // namespace meso
