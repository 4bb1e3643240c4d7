// SPDX-License-Identifier: Apache-2.0
#include "light.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace meso::picture {
namespace {

constexpr int sky_rays = 4;           // per camera ray; a pixel has nine of those by default
constexpr double sky_reach = 0.3;     // of the part's radius: what is farther away does not darken a spot
constexpr double lamp_radius = 0.05;  // as seen from distance 1: shadows soften, and stay readable between struts
constexpr double clearance = 2e-4;    // of the part's radius: rays start off the surface they leave

constexpr Color metal{0.30, 0.385, 0.475};
constexpr Color cut_metal{0.60, 0.30, 0.14};     // a section is told from the surface at a glance
constexpr Color metal_bounce{0.26, 0.33, 0.41};  // light that reaches a spot from other metal
constexpr Color lamp{2.5, 2.36, 2.16};

Color operator*(Color a, Color b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

Color mix(Color a, Color b, double t) { return (1 - t) * a + t * b; }

/// Right-handed unit vectors around a unit normal (Duff et al., "Building an orthonormal basis, revisited", 2017).
struct Tangents {
  Vec3 x, y;
};
Tangents tangents(Vec3 n) {
  const double sign = std::copysign(1.0, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
  return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}};
}

Vec3 disk_around(Vec3 axis, Samples::Point p, double radius) {
  const Tangents t = tangents(axis);
  const double r = radius * std::sqrt(p.u), angle = 2 * std::numbers::pi * p.v;
  return r * std::cos(angle) * t.x + r * std::sin(angle) * t.y;
}

std::uint32_t scrambled(std::uint32_t x, std::uint32_t y) {
  std::uint32_t h = x * 0x8DA6B343U + y * 0xD8163841U;
  h = (h ^ (h >> 16)) * 0x7FEB352DU;
  h = (h ^ (h >> 15)) * 0x846CA68BU;
  return h ^ (h >> 16);
}

}  // namespace

Samples::Samples(std::uint32_t x, std::uint32_t y) : u_(scrambled(x, y)), v_(scrambled(y, x ^ 0x9E3779B9U)) {}

Samples::Point Samples::next() {
  u_ += 0xC13FA9A9U;  // 2^32 / 1.3247..., the plastic number
  v_ += 0x91E10DA5U;  // 2^32 / 1.3247...^2
  return {u_ * 0x1p-32, v_ * 0x1p-32};
}

Studio::Studio(const View& view, const Tracer& tracer) : vertical_(view.vertical), tracer_(tracer) {
  const Vec3 level = cross(view.right, view.vertical);  // towards the viewer, along the horizon
  to_lamp_ = normalized(-0.62 * view.right + 1.0 * view.vertical + 0.55 * level);
}

Color Studio::paper(double height) {
  return mix({0.93, 0.94, 0.95}, {0.74, 0.77, 0.80}, height * height * (3 - 2 * height));
}

Color Studio::sky(Vec3 direction) const {
  const double height = dot(direction, vertical_);
  const Color horizon{0.80, 0.84, 0.88}, zenith{1.02, 1.06, 1.12}, floor{0.36, 0.35, 0.34};
  return height > 0 ? mix(horizon, zenith, height) : mix(horizon, floor, std::sqrt(-height));
}

Color Studio::sky_light(const Surface::Spot& spot, Vec3 start, Samples& samples) const {
  Color sum;
  for (int i = 0; i < sky_rays; ++i) {
    // Cosine-weighted: a point of the unit disk, raised onto the hemisphere.
    const Samples::Point p = samples.next();
    const Vec3 direction = disk_around(spot.normal, p, 1) + std::sqrt(1 - p.u) * spot.normal;
    const bool free = dot(direction, spot.facet_normal) > 0 && !tracer_.blocked(start, direction, sky_reach);
    sum += free ? sky(direction) : 0.35 * (metal_bounce * sky(spot.normal));
  }
  return sum / sky_rays;
}

double Studio::lamp_light(const Surface::Spot& spot, Samples& samples) const {
  const double slope = dot(spot.normal, to_lamp_);
  if (slope <= 0) return 0;
  const Vec3 direction = normalized(to_lamp_ + disk_around(to_lamp_, samples.next(), lamp_radius));
  const Vec3 start = spot.lifted + clearance * spot.normal;
  return tracer_.blocked(start, direction, HUGE_VAL) ? 0 : slope;
}

Color Studio::shade(Surface::Spot spot, Vec3 to_viewer, Samples& samples) const {
  if (dot(spot.facet_normal, to_viewer) < 0) {  // an open or inverted mesh, seen from behind
    spot.facet_normal = -spot.facet_normal;
    spot.normal = -spot.normal;
    spot.lifted = spot.position;
  }
  // At a silhouette the smooth normal may look away; bend it back to grazing.
  const double facing = dot(spot.normal, to_viewer);
  if (facing < 0.02) spot.normal = normalized(spot.normal + (0.02 - facing) * to_viewer);

  const Vec3 start = spot.position + clearance * spot.facet_normal;
  const Color from_sky = sky_light(spot, start, samples);
  const double from_lamp = lamp_light(spot, samples);
  const Color diffuse = (spot.section ? cut_metal : metal) * (0.62 * from_sky + from_lamp * lamp / std::numbers::pi);

  // Brushed metal: the sky mirrored, dimmed where the spot hardly sees it, and a broad highlight of the lamp.
  const double cosine = std::max(0.0, dot(spot.normal, to_viewer));
  const double fresnel = 0.10 + 0.55 * std::pow(1 - cosine, 5);
  const Vec3 mirrored = 2 * cosine * spot.normal - to_viewer;
  const Color reflected = fresnel * (sky(mirrored) * from_sky);
  const Vec3 half = normalized(to_lamp_ + to_viewer);
  const double glint = from_lamp * 0.45 * std::pow(std::max(0.0, dot(half, spot.normal)), 50);
  return diffuse + reflected + glint * lamp;
}

}  // namespace meso::picture
