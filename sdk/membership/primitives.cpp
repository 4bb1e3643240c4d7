// SPDX-License-Identifier: Apache-2.0
#include "primitives.hpp"

#include <algorithm>

namespace meso::membership {
namespace {

double squared(Vec3 v) { return dot(v, v); }

bool in_ball(Vec3 centre, double radius, Vec3 p) { return squared(p - centre) <= radius * radius; }

bool in_cap(BeamCap cap, Vec3 end, Vec3 outwards, double radius, Vec3 p) {
  if (cap == BeamCap::butt) return false;
  return in_ball(end, radius, p) && (cap == BeamCap::sphere || dot(p - end, outwards) >= 0);
}

/// An odd number of sides crosses the ray to the right.
bool in_corners(const std::vector<std::pair<double, double>>& corners, double x, double y) {
  bool odd = false;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto [ax, ay] = corners[i];
    const auto [bx, by] = corners[(i + 1) % corners.size()];
    if ((ay > y) != (by > y) && x < ax + (y - ay) * (bx - ax) / (by - ay)) odd = !odd;
  }
  return odd;
}

}  // namespace

bool contains(const eval::BoxShape& box, Vec3 p) {
  for (std::size_t i = 0; i < 3; ++i)
    if (p[i] < box.corner[i] || p[i] > box.corner[i] + box.size[i]) return false;
  return true;
}

bool contains(const eval::SphereShape& sphere, Vec3 p) { return in_ball(sphere.center, sphere.radius, p); }

bool contains(const eval::EllipsoidShape& ellipsoid, Vec3 p) {
  const Vec3 d = p - ellipsoid.center;
  return squared({d.x / ellipsoid.radii.x, d.y / ellipsoid.radii.y, d.z / ellipsoid.radii.z}) <= 1;
}

bool contains(const eval::CylinderShape& cylinder, Vec3 p) {
  return contains(eval::ConeShape{cylinder.from, cylinder.to, cylinder.radius, cylinder.radius}, p);
}

bool contains(const eval::ConeShape& cone, Vec3 p) {
  const Vec3 axis = cone.to - cone.from;
  const double t = dot(p - cone.from, axis) / squared(axis);
  return t >= 0 && t <= 1 &&
         in_ball(cone.from + t * axis, cone.radius_from + t * (cone.radius_to - cone.radius_from), p);
}

bool contains(const eval::TorusShape& torus, Vec3 p) {
  const Vec3 d = p - torus.center;
  const double along = dot(d, torus.axis), across = norm(d - along * torus.axis) - torus.major_radius;
  return along * along + across * across <= torus.minor_radius * torus.minor_radius;
}

bool contains(const eval::ExtrusionShape& extrusion, Vec3 p) {
  return p.z >= extrusion.z && p.z <= extrusion.z + extrusion.height && in_corners(extrusion.points, p.x, p.y);
}

bool contains(const eval::RevolutionShape& revolution, Vec3 p) {
  return in_corners(revolution.points, std::hypot(p.x, p.y), p.z);
}

/// The ray along +z leaves through one face more than it enters by. Faces with a common edge see the same corners from
/// above, so no ray passes between them.
bool contains(const eval::PolyhedronShape& polyhedron, Vec3 p) {
  const auto& vertices = polyhedron.body.vertices;
  bool odd = false;
  std::vector<std::pair<double, double>> corners;
  for (const auto& face : polyhedron.body.faces) {
    corners.clear();
    Vec3 normal;
    for (std::size_t i = 0; i < face.size(); ++i) {
      const Vec3 a = vertices[face[i]] - p, b = vertices[face[(i + 1) % face.size()]] - p;
      normal += cross(a, b);
      corners.emplace_back(a.x, a.y);
    }
    if (normal.z == 0 || !in_corners(corners, 0, 0)) continue;
    const Vec3 a = vertices[face.front()] - p;
    if (dot(normal, a) / normal.z > 0) odd = !odd;  // the height of the face's plane above p
  }
  return odd;
}

bool contains(const eval::BeamsShape& beams, Vec3 p) {
  const auto in_node = [&](const eval::StrutNode& node) {
    return node.ball_radius > 0 && in_ball(node.position, node.ball_radius, p);
  };
  const auto in_strut = [&](const eval::Strut& strut) {
    const Vec3 from = beams.nodes[strut.from].position, to = beams.nodes[strut.to].position;
    return contains(eval::ConeShape{from, to, strut.radius_from, strut.radius_to}, p) ||
           in_cap(strut.cap_from, from, from - to, strut.radius_from, p) ||
           in_cap(strut.cap_to, to, to - from, strut.radius_to, p);
  };
  return std::ranges::any_of(beams.nodes, in_node) || std::ranges::any_of(beams.struts, in_strut);
}

}  // namespace meso::membership
