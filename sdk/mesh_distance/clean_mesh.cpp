// SPDX-License-Identifier: Apache-2.0
#include "clean_mesh.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cassert>
#include <functional>
#include <span>
#include <tuple>

#include "mend_mesh.hpp"
#include "point_keys.hpp"
#include "spatial_order.hpp"

namespace meso::implicit {
namespace {

constexpr std::size_t grain = 1 << 14;
using Blocks = tbb::blocked_range<std::size_t>;

/// std::fmin is a call.
void extend(Box3& box, Vec3 p) {
  for (std::size_t i = 0; i < 3; ++i) {
    box.min[i] = std::min(box.min[i], p[i]);
    box.max[i] = std::max(box.max[i], p[i]);
  }
}

Box3 box_of(const std::vector<Vec3>& points) {
  Box3 box;
  for (const Vec3& p : points) extend(box, p);
  return box;
}

bool in_range(const TriangleMesh& mesh) {
  const auto fits = [](double x) { return std::abs(x) < 1e60; };  // a NaN does not
  return std::all_of(mesh.points.begin(), mesh.points.end(),
                     [&](Vec3 p) { return fits(p.x) && fits(p.y) && fits(p.z); });
}

std::vector<std::uint64_t> keys_of(const std::vector<Vec3>& points) {
  std::vector<std::uint64_t> keys(points.size());
  tbb::parallel_for(Blocks(0, keys.size(), grain), [&](const Blocks& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) keys[i] = point_key(without_specks(points[i]));
  });
  return keys;
}

/// A face without its direction: sorted keys, and whether sorting them turned it over.
struct Face {
  std::array<std::uint64_t, 3> keys;
  bool turned;
  std::size_t at;
};

Face face_of(const std::array<std::uint32_t, 3>& corners, const std::vector<std::uint64_t>& keys, std::size_t at) {
  Face f{{keys[corners[0]], keys[corners[1]], keys[corners[2]]}, false, at};
  const auto order = [&](std::size_t i, std::size_t j) {
    if (f.keys[j] < f.keys[i]) std::swap(f.keys[i], f.keys[j]), f.turned = !f.turned;
  };
  order(0, 1);
  order(1, 2);
  order(0, 1);
  return f;
}

/// What becomes of a triangle: kept, or it has a partner with the other side out.
enum class Fate : std::uint8_t { kept, front, back };

/// Pairs, among triangles at one place, those that stand with both sides out.
void pair_opposite(std::span<const Placed> run, const TriangleMesh& mesh, const std::vector<std::uint64_t>& keys,
                   std::vector<Fate>& fates, std::size_t first) {
  std::vector<Face> faces;
  for (std::size_t i = 0; i < run.size(); ++i) {
    const Face f = face_of(mesh.triangles[run[i].triangle()], keys, first + i);
    if (f.keys[0] != f.keys[1] && f.keys[1] != f.keys[2]) faces.push_back(f);
  }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    return std::tie(a.keys, a.turned, a.at) < std::tie(b.keys, b.turned, b.at);
  });
  for (auto begin = faces.begin(); begin != faces.end();) {
    const auto turned =
        std::find_if(begin, faces.end(), [&](const Face& f) { return f.keys != begin->keys || f.turned; });
    const auto end = std::find_if(turned, faces.end(), [&](const Face& f) { return f.keys != begin->keys; });
    const auto pairs = std::min(turned - begin, end - turned);
    for (auto i = 0; i < pairs; ++i) {
      fates[begin[i].at] = Fate::front;
      fates[turned[i].at] = Fate::back;
    }
    begin = end;
  }
}

/// Removes triangles that stand with both sides out: nothing is between them. A mesh of nothing else is a sheet that
/// was written with both sides; it keeps one of them. Returns how many went.
std::uint64_t drop_opposite(std::vector<Placed>& order, const TriangleMesh& mesh,
                            const std::vector<std::uint64_t>& keys) {
  std::vector<Fate> fates;
  for (std::size_t first = 0; first < order.size();) {
    std::size_t last = first + 1;
    while (last < order.size() && order[last].place() == order[first].place()) ++last;
    if (last - first > 1) {
      if (fates.empty()) fates.resize(order.size(), Fate::kept);
      pair_opposite(std::span(order).subspan(first, last - first), mesh, keys, fates, first);
    }
    first = last;
  }
  if (fates.empty()) return 0;
  const bool sheet = std::find(fates.begin(), fates.end(), Fate::kept) == fates.end();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (fates[i] == Fate::kept || (sheet && fates[i] == Fate::front)) order[kept++] = order[i];
  }
  const std::size_t gone = order.size() - kept;
  order.resize(kept);
  return gone;
}

/// Sums over triangles.
struct Sums {
  std::uint64_t boundary = 0;  ///< of edge keys: zero if every edge is used as often in one direction as in the other
  double volume = 0;
  std::uint64_t degenerate = 0;
  Box3 box;

  friend Sums operator+(Sums a, const Sums& b) {
    extend(a.box, b.box.min);
    extend(a.box, b.box.max);
    return {a.boundary + b.boundary, a.volume + b.volume, a.degenerate + b.degenerate, a.box};
  }
};

/// The corners themselves, in order.
Sums gather(std::vector<Triangle>& out, const std::vector<Placed>& order, const TriangleMesh& mesh,
            const std::vector<std::uint64_t>& keys, Vec3 middle, const std::vector<bool>& turned) {
  out.resize(order.size());
  return tbb::parallel_deterministic_reduce(
      Blocks(0, order.size(), grain), Sums{},
      [&](const Blocks& range, Sums s) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          if (i + 2 * prefetch_distance < order.size())
            __builtin_prefetch(mesh.triangles.data() + order[i + 2 * prefetch_distance].triangle());
          if (i + prefetch_distance < order.size()) {
            for (const std::uint32_t p : mesh.triangles[order[i + prefetch_distance].triangle()]) {
              __builtin_prefetch(mesh.points.data() + p);
              __builtin_prefetch(keys.data() + p);
            }
          }
          std::array<std::uint32_t, 3> corners = mesh.triangles[order[i].triangle()];
          if (!turned.empty() && turned[i]) std::swap(corners[1], corners[2]);
          Triangle& t = out[i];
          for (std::size_t c = 0; c < 3; ++c) {
            t[c] = without_specks(mesh.points[corners[c]]);
            extend(s.box, t[c]);
            s.boundary += edge_key(keys[corners[c]], keys[corners[(c + 1) % 3]]);
          }
          const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
          s.volume += dot(n, t[0] - middle);
          s.degenerate += n == Vec3{} ? 1 : 0;
        }
        return s;
      },
      std::plus<>());
}

void report(const MeshQuality& q, const std::string& name, DiagnosticSink& sink) {
  const auto warn = [&](Code code, std::vector<std::uint64_t> numbers) {
    Diagnostic d{.code = code, .where = {.file = name}};
    for (const std::uint64_t n : numbers) d.args.push_back(std::to_string(n));
    sink.report(std::move(d));
  };
  if (q.cancelled + q.repeated > 0) warn(Code::mesh_repeated, {q.cancelled + q.repeated});
  if (q.turned > 0) warn(Code::mesh_turned, {q.turned});
  if (q.inside_out) warn(Code::mesh_inside_out, {});
  if (!q.closed) warn(Code::mesh_not_closed, {q.open_edges, q.flipped_edges, q.multiple_edges});
}

}  // namespace

std::optional<CleanMesh> clean_mesh(const TriangleMesh& mesh, const std::string& name, StopPoll& stop,
                                    DiagnosticSink& sink) {
  assert(std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& t) {
    return std::all_of(t.begin(), t.end(), [&](std::uint32_t p) { return p < mesh.points.size(); });
  }));
  if (mesh.triangles.empty()) {
    sink.report({.code = Code::mesh_empty, .where = {.file = name}});
    return {};
  }
  if (!in_range(mesh)) {
    sink.report({.code = Code::mesh_coordinates, .where = {.file = name}});
    return {};
  }
  const Box3 points_box = box_of(mesh.points);
  const Vec3 middle = 0.5 * points_box.min + 0.5 * points_box.max;
  std::vector<Placed> order = spatial_order(mesh, points_box, stop);
  if (stop()) return {};
  const std::vector<std::uint64_t> keys = keys_of(mesh.points);
  CleanMesh out;
  MeshQuality& quality = out.quality;
  quality.cancelled = drop_opposite(order, mesh, keys);
  Sums sums = gather(out.triangles, order, mesh, keys, middle, {});
  if (stop()) return {};
  if (sums.boundary != 0) {
    const std::vector<bool> turned = mend_mesh(order, mesh, keys, quality);
    sums = gather(out.triangles, order, mesh, keys, middle, turned);
    if (stop()) return {};
  }
  out.box = sums.box;
  quality.triangles = order.size();
  quality.degenerate = sums.degenerate;
  quality.closed = sums.boundary == 0;
  quality.inside_out = quality.closed && sums.volume < 0;
  report(out.quality, name, sink);
  return out;
}

Vec3 without_specks(Vec3 p) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (std::abs(p[i]) < 1e-60) p[i] = 0;
  }
  return p;
}

}  // namespace meso::implicit
