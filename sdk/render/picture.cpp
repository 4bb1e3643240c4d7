// SPDX-License-Identifier: Apache-2.0
#include "meso/render/picture.hpp"

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cmath>

#include "camera.hpp"
#include "light.hpp"
#include "surface.hpp"
#include "tracer.hpp"

namespace meso::picture {
namespace {

std::uint8_t srgb(double linear) {
  const double c = std::clamp(linear, 0.0, 1.0);
  const double encoded = c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255 * encoded));
}

/// Leaves darks and mid-tones as they are and rolls highlights off, so that bright metal keeps its hue.
double developed(double light) {
  constexpr double shoulder = 0.7;
  return light <= shoulder ? light : 1 - (1 - shoulder) * std::exp((shoulder - light) / (1 - shoulder));
}

Box3 bounds_of(const std::vector<Vec3>& points) {
  Box3 bounds;
  for (const Vec3& p : points) bounds.extend(p);
  return bounds;
}

struct Scene {
  Camera camera;
  Studio studio;
  const Tracer& tracer;
  const Surface& surface;
};

/// What a camera ray sees: the surface, or the section if the ray comes into the kept half inside the material.
std::optional<Surface::Spot> first_spot(const Scene& scene, Vec3 direction) {
  const Vec3 eye = scene.camera.position();
  const auto entry = scene.tracer.entry(eye, direction);
  const auto hit = scene.tracer.first_hit(entry.value_or(eye), direction);
  if (!hit) return std::nullopt;
  const Surface::Spot spot = scene.surface.at(hit->triangle, hit->u, hit->v);
  if (!entry || dot(spot.facet_normal, direction) <= 0) return spot;
  const Vec3 normal = scene.tracer.section_normal();
  return Surface::Spot{.position = *entry, .facet_normal = normal, .normal = normal, .section = true, .lifted = *entry};
}

/// The plane of a cut in the surface's own coordinates, its normal towards the viewer.
Tracer::HalfSpace half_space(const Cut& cut, const Surface& surface, Vec3 eye) {
  Vec3 on_plane, normal;
  on_plane[cut.axis] = cut.position;
  normal[cut.axis] = 1;
  const double offset = surface.to_unit_ball(on_plane)[cut.axis];
  return eye[cut.axis] > offset ? Tracer::HalfSpace{normal, offset} : Tracer::HalfSpace{-normal, -offset};
}

Color pixel(const Scene& scene, const RenderOptions& options, std::uint32_t x, std::uint32_t y) {
  Samples samples(x, y);
  Color sum;
  const std::uint32_t n = options.samples;
  for (std::uint32_t i = 0; i < n * n; ++i) {
    // Correlated rooks: no two rays share a row or a column, so that nearly level edges get n * n shades, not n.
    const std::uint32_t column = i % n, row = i / n;
    const double px = x + (column + (row + 0.5) / n) / n, py = y + (row + (n - column - 0.5) / n) / n;
    const Vec3 direction = scene.camera.ray(px, py);
    const auto spot = first_spot(scene, direction);
    const Color color = spot ? scene.studio.shade(*spot, -direction, samples) : Studio::paper(py / options.height);
    // Developed one by one: a glint next to paper must not outshine the whole pixel.
    sum += {developed(color.x), developed(color.y), developed(color.z)};
  }
  return sum / (n * n);
}

}  // namespace

std::optional<Image> draw(const TriangleMesh& mesh, const RenderOptions& options, const RunOptions& run,
                          DiagnosticSink& sink) {
  assert(options.width >= 1 && options.width <= 16384 && options.height >= 1 && options.height <= 16384);
  assert(options.samples >= 1 && options.samples <= 8);
  run.report("render", 0);
  const Surface surface(mesh);
  if (surface.triangles().empty()) {
    sink.report({.code = Code::render_nothing});
    return std::nullopt;
  }
  std::optional<Tracer> tracer = Tracer::over(surface);
  if (!tracer) {
    sink.report({.code = Code::render_memory, .args = {std::to_string(surface.triangles().size())}});
    return std::nullopt;
  }
  const View view = view_for(options, bounds_of(surface.points()));
  const Scene scene{Camera(view, surface.points(), options.width, options.height), Studio(view, *tracer), *tracer,
                    surface};
  if (options.cut) tracer->keep_only(half_space(*options.cut, surface, scene.camera.position()));

  Image image{options.width, options.height, {}};
  image.rgb.resize(std::size_t{3} * options.width * options.height);
  const auto draw_row = [&](std::uint32_t y) {
    auto* out = image.rgb.data() + std::size_t{3} * options.width * y;
    for (std::uint32_t x = 0; x < options.width; ++x) {
      const Color color = pixel(scene, options, x, y);
      for (std::size_t i = 0; i < 3; ++i) *out++ = srgb(color[i]);
    }
  };

  // Bands of rows, so that progress is told and a stop is asked for from this thread alone.
  constexpr std::uint32_t band = 16;
  const auto cores = static_cast<unsigned>(tbb::info::default_concurrency());
  tbb::task_arena arena(static_cast<int>(run.jobs == 0 ? cores : std::min(cores, run.jobs)));
  for (std::uint32_t y = 0; y < options.height; y += band) {
    if (run.should_stop()) {
      sink.report({.code = Code::cancelled});
      return std::nullopt;
    }
    run.report("render", static_cast<double>(y) / options.height);
    const std::uint32_t end = std::min(y + band, options.height);
    arena.execute([&] { tbb::parallel_for(y, end, draw_row, tbb::simple_partitioner{}); });
  }
  run.report("render", 1);
  return image;
}

}  // namespace meso::picture
