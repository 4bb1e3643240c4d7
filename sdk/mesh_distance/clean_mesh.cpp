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

Box3 box_of(const TriangleMesh& mesh) {
  return tbb::parallel_reduce(
      Blocks(0, mesh.triangles.size(), grain), Box3{},
      [&](const Blocks& range, Box3 box) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          for (const std::uint32_t p : mesh.triangles[i]) box.extend(mesh.points[p]);
        }
        return box;
      },
      [](Box3 a, const Box3& b) {
        a.extend(b.min);
        a.extend(b.max);
        return a;
      });
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
    const Face f = face_of(mesh.triangles[run[i].triangle], keys, first + i);
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
    while (last < order.size() && order[last].place == order[first].place) ++last;
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

/// Zero if every edge is used as often in one direction as in the other.
std::uint64_t boundary_key(const std::vector<Placed>& order, const TriangleMesh& mesh,
                           const std::vector<std::uint64_t>& keys) {
  return tbb::parallel_reduce(
      Blocks(0, order.size(), grain), std::uint64_t{0},
      [&](const Blocks& range, std::uint64_t sum) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          const auto& t = mesh.triangles[order[i].triangle];
          const std::uint64_t a = keys[t[0]], b = keys[t[1]], c = keys[t[2]];
          sum += edge_key(a, b) + edge_key(b, c) + edge_key(c, a);
        }
        return sum;
      },
      std::plus<>());
}

/// The corners themselves, and what takes no second look at them.
void gather(CleanMesh& out, const std::vector<Placed>& order, const TriangleMesh& mesh,
            const std::vector<bool>& turned) {
  struct Sums {
    double volume = 0;
    std::uint64_t degenerate = 0;
  };
  out.triangles.resize(order.size());
  const Vec3 middle = 0.5 * out.box.min + 0.5 * out.box.max;
  const Sums sums = tbb::parallel_deterministic_reduce(
      Blocks(0, order.size(), grain), Sums{},
      [&](const Blocks& range, Sums s) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          const auto& corners = mesh.triangles[order[i].triangle];
          Triangle& t = out.triangles[i];
          for (std::size_t c = 0; c < 3; ++c) t[c] = without_specks(mesh.points[corners[c]]);
          if (!turned.empty() && turned[i]) std::swap(t[1], t[2]);
          const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
          s.volume += dot(n, t[0] - middle);
          s.degenerate += n == Vec3{} ? 1 : 0;
        }
        return s;
      },
      [](const Sums& a, const Sums& b) {
        return Sums{a.volume + b.volume, a.degenerate + b.degenerate};
      });
  out.quality.triangles = order.size();
  out.quality.degenerate = sums.degenerate;
  out.quality.inside_out = sums.volume < 0;
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
  CleanMesh out{.triangles = {}, .box = box_of(mesh), .quality = {}};
  std::vector<Placed> order = spatial_order(mesh, out.box);
  if (stop()) return {};
  const std::vector<std::uint64_t> keys = keys_of(mesh.points);
  out.quality.cancelled = drop_opposite(order, mesh, keys);
  out.quality.closed = boundary_key(order, mesh, keys) == 0;
  if (stop()) return {};
  std::vector<bool> turned;
  if (!out.quality.closed) turned = mend_mesh(order, mesh, keys, out.quality);
  if (stop()) return {};
  gather(out, order, mesh, turned);
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
