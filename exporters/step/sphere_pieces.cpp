// SPDX-License-Identifier: Apache-2.0
#include "sphere_pieces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "meso/brep/placement.hpp"
#include "sphere_frame.hpp"

namespace meso::step {

using namespace brep;

namespace {

constexpr double clear_enough = 0.25;  // sine of the angle between a cut and a loop, seen from the cut's ends
constexpr int steps_of_a_cut = 12, spread_points = 80;

Vec3 unit(Vec3 v) { return (1 / norm(v)) * v; }

/// Where arcs of great circles, drawn as polygons, cross.
bool cross_each_other(Vec3 a, Vec3 b, Vec3 p, Vec3 q) {
  const Vec3 ab = cross(a, b), pq = cross(p, q);
  return (dot(ab, p) < 0) != (dot(ab, q) < 0) && (dot(pq, a) < 0) != (dot(pq, b) < 0) && dot(a + b, p + q) > 0;
}

struct Cut {
  Vec3 middle;
  double clear = 0;
};

class Divider {
 public:
  Divider(const SphereSurface& sphere, const FaceTemplate& face, const Template& geometry) : sphere_(sphere) {
    copy(face, geometry);
  }

  SpherePieces divide() {
    std::vector<FaceTemplate> open{std::exchange(face_, {})};
    while (!open.empty()) {
      FaceTemplate piece = std::move(open.back());
      open.pop_back();
      if (auto two = halves(piece)) {
        open.push_back(std::move((*two)[0]));
        open.push_back(std::move((*two)[1]));
      } else {
        out_.pieces.push_back(std::move(piece));
      }
    }
    return std::move(out_);
  }

 private:
  using Ring = std::vector<Coedge>;

  static bool has_seam(const FaceTemplate& face) {
    std::set<std::tuple<std::uint32_t, Index3>> seen;
    for (const Ring& ring : face.loops)
      for (const Coedge& use : ring)
        if (!seen.insert({use.edge, use.offset}).second) return true;
    return false;
  }

  /// The face with edges and vertices of its own, all in its own cell.
  void copy(const FaceTemplate& face, const Template& geometry) {
    face_ = {.surface = face.surface, .reversed = face.reversed};
    out_.border.lattice = geometry.lattice;
    std::map<std::uint32_t, std::uint32_t> edges, vertices;
    const auto local = [](auto& known, std::vector<std::uint32_t>& list, std::uint32_t global) {
      const auto [at, fresh] = known.try_emplace(global, static_cast<std::uint32_t>(list.size()));
      if (fresh) list.push_back(global);
      return at->second;
    };
    for (const auto& loop : face.loops) {
      Ring& ring = face_.loops.emplace_back();
      for (Coedge use : loop) {
        const EdgeTemplate& edge = geometry.edges[use.edge];
        use.edge = local(edges, out_.edges, use.edge);
        ring.push_back(use);
        if (use.edge < out_.border.edges.size()) continue;
        EdgeTemplate& own = out_.border.edges.emplace_back(edge);
        for (std::uint32_t& vertex : own.vertex) vertex = local(vertices, out_.vertices, vertex);
      }
    }
    for (const std::uint32_t vertex : out_.vertices) out_.border.vertices.push_back(geometry.vertices[vertex]);
  }

  [[nodiscard]] VertexKey start(const Coedge& use) const { return vertex_of(use, 0, out_.border); }
  [[nodiscard]] Vec3 direction(const VertexKey& v) const {
    return unit(out_.border.vertices[std::get<0>(v)] + cell_origin(out_.border, std::get<1>(v)) - sphere_.frame.origin);
  }

  std::optional<std::array<FaceTemplate, 2>> halves(const FaceTemplate& face) {
    if (has_seam(face)) return {};
    for (std::size_t r = 0; r < face.loops.size(); ++r) {
      const Ring& ring = face.loops[r];
      for (std::size_t i = 0; i < ring.size(); ++i)
        for (std::size_t k = i + 1; k < ring.size(); ++k)
          if (start(ring[i]) == start(ring[k])) return cut(face, r, i, k);
    }
    return {};
  }

  /// The ring passes one vertex before its uses i and k. The best cut from between to beyond.
  std::optional<std::array<FaceTemplate, 2>> cut(const FaceTemplate& face, std::size_t r, std::size_t i,
                                                 std::size_t k) {
    const Ring& ring = face.loops[r];
    const std::vector<std::vector<Vec3>> lines = points_of_loops(face, out_.border, sphere_.frame.origin);
    Cut best;
    std::size_t from = 0, to = 0;
    for (std::size_t a = i + 1; a < k; ++a)
      for (std::size_t b = k + 1; b < i + ring.size() && best.clear < clear_enough; ++b) {
        const Cut found = best_cut(direction(start(ring[a])), direction(start(ring[b % ring.size()])), lines);
        if (found.clear > best.clear) std::tie(best, from, to) = std::tuple(found, a, b % ring.size());
      }
    if (best.clear < clear_enough / 5) return {};
    const Ring there = add_edges(start(ring[from]), best.middle, start(ring[to]));
    std::array<FaceTemplate, 2> two;
    for (FaceTemplate& half : two) half = {.surface = face.surface, .reversed = face.reversed};
    Ring& left = two[0].loops.emplace_back(there);
    for (std::size_t s = to; s != from; s = (s + 1) % ring.size()) left.push_back(ring[s]);
    Ring& right = two[1].loops.emplace_back();
    for (std::size_t s = from; s != to; s = (s + 1) % ring.size()) right.push_back(ring[s]);
    right.push_back(there[1]);
    right.push_back(there[0]);
    right[right.size() - 1].reversed = right[right.size() - 2].reversed = true;
    const std::vector<Vec3> border = points_of_loops(two[0], out_.border, sphere_.frame.origin)[0];
    const Vec3 along = best.middle - direction(start(ring[from]));
    const Vec3 inside = unit(unit(best.middle + direction(start(ring[from]))) +
                             (face.reversed ? -1e-3 : 1e-3) * unit(cross(best.middle, along)));
    for (std::size_t other = 0; other < face.loops.size(); ++other) {
      if (other == r) continue;
      int crossings = 0;
      for (std::size_t s = 0; s < border.size(); ++s)
        crossings += cross_each_other(inside, lines[other].front(), border[s], border[(s + 1) % border.size()]);
      two[crossings % 2].loops.push_back(face.loops[other]);
    }
    return two;
  }

  [[nodiscard]] static Cut best_cut(Vec3 a, Vec3 b, const std::vector<std::vector<Vec3>>& lines) {
    Cut best;
    for (int i = 0; i < spread_points && best.clear < clear_enough; ++i) {
      const double h = 2 * (i + 0.5) / spread_points - 1, around = std::numbers::pi * (1 + std::sqrt(5.0)) * i;
      const double r = std::sqrt(1 - h * h);
      const Vec3 middle{r * std::cos(around), r * std::sin(around), h};
      const double clear = std::min(clearance(a, middle, lines, best.clear), clearance(b, middle, lines, best.clear));
      if (clear > best.clear) best = {middle, clear};
    }
    return best;
  }

  /// Of the arc from a vertex, in parts of the way from there; 0 where less than `least` or where it crosses a line.
  [[nodiscard]] static double clearance(Vec3 vertex, Vec3 middle, const std::vector<std::vector<Vec3>>& lines,
                                        double least) {
    if (dot(vertex, middle) < -0.9 || dot(vertex, middle) > 0.95) return 0;
    double clear = 2;
    Vec3 before = vertex;
    for (int s = 1; s <= steps_of_a_cut; ++s) {
      const double t = static_cast<double>(s) / steps_of_a_cut;
      const Vec3 p = unit((1 - t) * vertex + t * middle);
      for (const auto& line : lines)
        for (std::size_t i = 0; i < line.size(); ++i) {
          clear = std::min(clear, norm(line[i] - p) / norm(p - vertex));
          if (s > 1 && cross_each_other(before, p, line[i], line[(i + 1) % line.size()])) return 0;
        }
      if (clear <= least) return 0;
      before = p;
    }
    return clear;
  }

  Ring add_edges(const VertexKey& from, Vec3 middle, const VertexKey& to) {
    const auto vertex = static_cast<std::uint32_t>(out_.border.vertices.size());
    out_.border.vertices.push_back(sphere_.frame.origin + sphere_.radius * middle);
    return {add_edge(from, {vertex, {}}), add_edge({vertex, {}}, to)};
  }
  Coedge add_edge(const VertexKey& from, const VertexKey& to) {
    const Vec3 x = direction(from), z = unit(cross(x, direction(to)));
    out_.border.edges.push_back({.curve = Circle{{sphere_.frame.origin, z, x}, sphere_.radius},
                                 .vertex = {std::get<0>(from), std::get<0>(to)},
                                 .vertex_offset = {std::get<1>(from), std::get<1>(to)}});
    return {.edge = static_cast<std::uint32_t>(out_.border.edges.size() - 1)};
  }

  SphereSurface sphere_;
  FaceTemplate face_;
  SpherePieces out_;
};

}  // namespace

SpherePieces divided(const SphereSurface& sphere, const FaceTemplate& face, const Template& geometry) {
  SpherePieces made = Divider(sphere, face, geometry).divide();
  return made.pieces.size() > 1 ? std::move(made) : SpherePieces{};
}

}  // namespace meso::step
