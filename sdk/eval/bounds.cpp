// SPDX-License-Identifier: Apache-2.0
#include "meso/eval/bounds.hpp"

#include <algorithm>
#include <cmath>

namespace meso::eval {
namespace {

Box3 around(Vec3 center, Vec3 half) {
  Box3 box;
  box.extend(center - half);
  box.extend(center + half);
  return box;
}
Box3 around(Vec3 center, double radius) { return around(center, Vec3{radius, radius, radius}); }

void extend(Box3& box, const Box3& other) {
  if (other.empty()) return;
  box.extend(other.min);
  box.extend(other.max);
}

/// Half extents of a disc with unit normal n.
Vec3 disc_half(Vec3 n, double radius) {
  const auto half = [&](double c) { return radius * std::sqrt(std::fmax(0, 1 - c * c)); };
  return {half(n.x), half(n.y), half(n.z)};
}

Box3 bounds_of(const BoxShape& s) { return box_of(s); }
Box3 bounds_of(const SphereShape& s) { return around(s.center, s.radius); }
Box3 bounds_of(const EllipsoidShape& s) { return around(s.center, s.radii); }
Box3 bounds_of(const ConeShape& s) {
  const Vec3 n = (s.to - s.from) / norm(s.to - s.from);
  Box3 box = around(s.from, disc_half(n, s.radius_from));
  extend(box, around(s.to, disc_half(n, s.radius_to)));
  return box;
}
Box3 bounds_of(const CylinderShape& s) { return bounds_of(ConeShape{s.from, s.to, s.radius, s.radius}); }
Box3 bounds_of(const TorusShape& s) {
  const Vec3 half = disc_half(s.axis, s.major_radius);
  return around(s.center, half + Vec3{s.minor_radius, s.minor_radius, s.minor_radius});
}
Box3 bounds_of(const ExtrusionShape& s) {
  Box3 box;
  for (const auto& [x, y] : s.points) {
    box.extend({x, y, s.z});
    box.extend({x, y, s.z + s.height});
  }
  return box;
}

Box3 bounds_of(const RevolutionShape& s) {
  Box3 box;
  for (const auto& [r, z] : s.points) {
    box.extend({-r, -r, z});
    box.extend({r, r, z});
  }
  return box;
}
Box3 bounds_of(const PolyhedronShape& s) {
  Box3 box;
  for (const Vec3 p : s.body.vertices) box.extend(p);
  return box;
}

/// P moves by at most |dq| per linear or distance coordinate, and by the arm's length times the angle per circular one.
Box3 bounds_of(const VolumeElementShape& s) {
  const auto& axes = s.system->axes();
  std::vector<double> middle(axes.size(), 0);
  double arm = 0, reach = 0, turned = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double half = (s.to[i] - s.from[i]) / 2;
    middle[s.axes[i]] = s.from[i] + half;
    switch (axes[s.axes[i]].kind) {
      case AxisKind::distance:
        arm += std::fmax(std::abs(s.from[i]), std::abs(s.to[i]));
        [[fallthrough]];
      case AxisKind::linear:
        reach += half;
        break;
      case AxisKind::circular:
        turned += half;
        break;
      case AxisKind::scalar:
        break;
    }
  }
  return around(s.system->point(middle), (reach + arm * turned) * (1 + 1e-12));
}

Box3 bounds_of(const BeamsShape& s) {
  Box3 box;
  for (const StrutNode& n : s.nodes) {
    if (n.ball_radius > 0) extend(box, around(n.position, n.ball_radius));
  }
  // A sphere about each end holds the disc and every cap.
  for (const Strut& strut : s.struts) {
    extend(box, around(s.nodes[strut.from].position, strut.radius_from));
    extend(box, around(s.nodes[strut.to].position, strut.radius_to));
  }
  return box;
}

std::optional<Box3> bounds_of_all(const std::vector<Shape>& shapes) {
  Box3 box;
  for (const Shape& shape : shapes) {
    const auto one = bounds(shape);
    if (!one) return std::nullopt;
    extend(box, *one);
  }
  return box;
}

std::optional<Box3> bounds_of(const BooleanShape& s) {
  if (s.operation == BooleanOperation::union_) return bounds_of_all(s.operands);
  if (s.operation == BooleanOperation::difference)
    return s.operands.empty() ? std::optional(Box3{}) : bounds(s.operands.front());
  // An intersection lies in each of its operands: those that are known suffice.
  std::optional<Box3> box;
  for (const Shape& operand : s.operands) {
    const auto one = bounds(operand);
    if (!one) continue;
    if (!box) box = one;
    for (std::size_t i = 0; i < 3; ++i) {
      box->min[i] = std::fmax(box->min[i], one->min[i]);
      box->max[i] = std::fmin(box->max[i], one->max[i]);
    }
  }
  if (!box) return std::nullopt;
  const bool meets = box->min.x <= box->max.x && box->min.y <= box->max.y && box->min.z <= box->max.z;
  return meets ? box : Box3{};
}

std::optional<Box3> bounds_of(const TransformedShape& s) {
  const auto inner = bounds_of_all(s.operands);
  return inner ? std::optional(transformed(s.map, *inner)) : std::nullopt;
}
std::optional<Box3> bounds_of(const ImportShape&) { return std::nullopt; }
std::optional<Box3> bounds_of(const ImplicitShape&) { return std::nullopt; }
std::optional<Box3> bounds_of(const PartShape&) { return std::nullopt; }

}  // namespace

std::optional<Box3> bounds(const Shape& shape) {
  return std::visit([](const auto& s) -> std::optional<Box3> { return bounds_of(s); }, shape.value);
}

Box3 transformed(const Affine& map, const Box3& box) {
  if (box.empty()) return box;
  const Vec3 half = 0.5 * (box.max - box.min);
  Vec3 image;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) image[row] += std::abs(map.linear(row, column)) * half[column];
  }
  return around(map * (box.min + half), image);
}

Box3 box_of(const BoxShape& box) {
  Box3 result;
  result.extend(box.corner);
  result.extend(box.corner + box.size);
  return result;
}

}  // namespace meso::eval
