// SPDX-License-Identifier: Apache-2.0
#include "camera.hpp"

#include <algorithm>
#include <cmath>

namespace meso::picture {
namespace {

constexpr double half_field = 0.16;  // radians along the picture's longer side: the perspective of a long lens
constexpr double margin = 0.06;      // of the half picture, kept free on each side

Up resolved(Up up, const Box3& b) {
  if (up != Up::automatic) return up;
  const Vec3 size = b.max - b.min;
  return size.z > 2 * std::max(size.x, size.y) ? Up::y : Up::z;
}

}  // namespace

View view_for(const RenderOptions& options, const Box3& bounds) {
  // Cyclic order keeps the frame right-handed: (east, north, vertical) = (x,y,z), (y,z,x) or (z,x,y).
  const Up up = resolved(options.up, bounds);
  const std::array<Vec3, 3> axes{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  const std::size_t vertical = up == Up::x ? 0 : up == Up::y ? 1 : 2;
  const Vec3 east = axes[(vertical + 1) % 3], north = axes[(vertical + 2) % 3];

  View view;
  view.vertical = axes[vertical];
  const Vec3 level = std::sin(options.azimuth) * east - std::cos(options.azimuth) * north;
  view.back = std::cos(options.elevation) * level + std::sin(options.elevation) * view.vertical;
  view.right = normalized(cross(view.vertical, view.back));
  view.up = cross(view.back, view.right);
  return view;
}

Camera::Camera(const View& view, const std::vector<Vec3>& points, std::uint32_t width, std::uint32_t height)
    : view_(view), width_(width), height_(height) {
  const double longer = std::max(width_, height_);
  tan_x_ = std::tan(half_field) * width_ / longer;
  tan_y_ = std::tan(half_field) * height_ / longer;

  // In view coordinates a point (x, y, z) is inside the frame of a camera at (a, b, c) when |x - a| <= t (c - z):
  // two half planes per direction. Their supports over all points give centre and distance.
  const double tx = (1 - margin) * tan_x_, ty = (1 - margin) * tan_y_;
  double x_plus = -HUGE_VAL, x_minus = -HUGE_VAL, y_plus = -HUGE_VAL, y_minus = -HUGE_VAL, nearest = -HUGE_VAL;
  for (const Vec3& p : points) {
    const double x = dot(p, view.right), y = dot(p, view.up), z = dot(p, view.back);
    x_plus = std::max(x_plus, tx * z + x);
    x_minus = std::max(x_minus, tx * z - x);
    y_plus = std::max(y_plus, ty * z + y);
    y_minus = std::max(y_minus, ty * z - y);
    nearest = std::max(nearest, z);
  }
  const double a = (x_plus - x_minus) / 2, b = (y_plus - y_minus) / 2;
  const double c = std::max({(x_plus + x_minus) / (2 * tx), (y_plus + y_minus) / (2 * ty), nearest});
  position_ = a * view.right + b * view.up + c * view.back;
}

Vec3 Camera::ray(double x, double y) const {
  const double u = (2 * x / width_ - 1) * tan_x_, v = (1 - 2 * y / height_) * tan_y_;
  return normalized(u * view_.right + v * view_.up - view_.back);
}

}  // namespace meso::picture
