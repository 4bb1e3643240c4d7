// SPDX-License-Identifier: Apache-2.0
#include "beam_graph_body.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "beam_graph_faces.hpp"
#include "beam_graph_mesh.hpp"
#include "beam_graph_rings.hpp"
#include "beam_graph_sphere.hpp"
#include "lattice/parallel.hpp"
#include "meso/base/number.hpp"
#include "occt.hpp"

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;

Vec3 unit(Vec3 v) { return v / norm(v); }

/// Of a cone about `axis` from `from` on, all around: Gauss's rule along it, exact for these powers.
FaceMoments cone_moments(Vec3 from, Vec3 axis, double length, double first, double second) {
  constexpr std::array<double, 3> node{-0.7745966692414834, 0, 0.7745966692414834};
  constexpr std::array<double, 3> weight{5.0 / 9, 8.0 / 9, 5.0 / 9};
  const double growth = (second - first) / length;
  FaceMoments m{.area = pi * (first + second) * std::hypot(length, second - first)};
  for (std::size_t k = 0; k < 3; ++k) {
    const double s = length / 2 * (1 + node[k]), r = first + growth * s, ds = weight[k] * length / 2 * 2 * pi * r;
    for (std::size_t i = 0; i < 3; ++i) {
      // Means around the circle: the normal's part along the axis, and half of what is across it.
      const double a = from[i] + s * axis[i], d = -growth * axis[i], half = (1 - axis[i] * axis[i]) / 2;
      m.vector_area[i] += d * ds;
      m.volume_moment[i] += (a * d + r * half) * ds;
      m.centroid_moment[i] += ((a * a + r * r * half) * d / 2 + a * r * half) * ds;
    }
  }
  return m;
}

double cap_volume(double ball, double height) { return pi * height * height * (ball - height / 3); }
double ball_volume(double radius) { return 4 * pi / 3 * radius * radius * radius; }

class BeamBody {
 public:
  BeamBody(const Joints& joints, const LatticeOptions& options)
      : joints_(joints),
        graph_(joints.graph),
        options_(options),
        faces_(joints.graph),
        rings_(joints, cuts_of(joints, options), faces_.geometry()) {}

  /// False: the run was to stop.
  bool make_faces() {
    for (std::uint32_t n = 0; n < graph_.nodes.size(); ++n) {
      if (n % 1024 == 0 && options_.run.should_stop()) return false;
      if (joints_.leaving[n].empty() && graph_.nodes[n].radius == 0) continue;
      faces_.begin(n);
      if (joints_.leaving[n].empty())
        add_ball(n);
      else if (!joints_.is_straight[n])
        add_faces_of_ball(n);
    }
    for (std::uint32_t s = 0; s < graph_.struts.size(); ++s) {
      faces_.begin(graph_.struts[s].node[0]);
      if (!joints_.is_swallowed[s]) add_strut(s);
    }
    return true;
  }

  /// False: the circles of a ball could not be divided finely enough, or the run was to stop.
  bool make_mesh() {
    return faces_.mesh(
        options_, [&](std::uint32_t edge, const MeshFineness& fineness) { return inner_points_of(edge, fineness); },
        [&](std::uint32_t strut, const MeshFineness& fineness) { return mesh_of_strut(strut, fineness); });
  }

  Body finish() {
    Body body = faces_.body();
    body.pieces_volume = pieces_volume();
    return body;
  }

 private:
  static std::vector<BallCuts> cuts_of(const Joints& joints, const LatticeOptions& options) {
    std::vector<BallCuts> cuts(joints.leaving.size());
    const auto divide = [&](std::size_t, std::size_t n) {
      if (joints.is_straight[n]) return true;
      std::vector<BallCap> caps;
      for (const Leaving l : joints.leaving[n]) caps.push_back({joints.direction(l), joints.end(l).angle});
      cuts[n] = cuts_between(caps);
      return true;
    };
    (void)in_parallel(cuts.size(), options.run, divide);  // make_faces() asks again whether to stop
    return cuts;
  }

  [[nodiscard]] Vec3 at(std::uint32_t node) const { return graph_.nodes[node].position; }

  void add_strut(std::uint32_t s) {
    const Ring &first = rings_.ring(2 * s), &second = rings_.ring(2 * s + 1);
    const Rings::Seam& seam = rings_.seam(s);
    const Vec3 axis = joints_.direction(2 * s), from = first.frame.origin, to = second.frame.origin;
    const double length = norm(to - from);
    FaceTemplate face;
    const double growth = graph_.struts[s].radius[1] - graph_.struts[s].radius[0];
    const double half_angle = std::atan(std::fabs(second.radius - first.radius) / length);
    if (growth == 0)
      face.surface = CylinderSurface{{from, axis, seam.direction}, first.radius};
    else if (growth > 0)
      face.surface = ConeSurface{{from, axis, seam.direction}, first.radius, half_angle};
    else
      face.surface = ConeSurface{{to, -axis, seam.direction}, second.radius, half_angle};
    std::vector<Coedge>& loop = face.loops.emplace_back(rings_.around(2 * s, seam.vertex[0]));
    loop.push_back({.edge = seam.edge});
    for (const Coedge& use : rings_.around(2 * s + 1, seam.vertex[1])) loop.push_back(use);
    loop.push_back({.edge = seam.edge, .reversed = true});
    face.moments = cone_moments(from, axis, length, first.radius, second.radius);
    for (const Ring* ring : {&first, &second}) {
      Vec3 reach;
      for (std::size_t i = 0; i < 3; ++i) reach[i] = ring->radius * std::sqrt(std::max(0.0, 1 - axis[i] * axis[i]));
      face.box.extend(ring->frame.origin - reach);
      face.box.extend(ring->frame.origin + reach);
    }
    faces_.add(std::move(face), s);
  }

  void add_faces_of_ball(std::uint32_t node) {
    const Vec3 centre = at(node);
    const double radius = graph_.nodes[node].radius;
    std::vector<Coedge> coedges;  // by id of the arc
    const std::vector<SphereCircle> circles = circles_of(node, coedges);
    for (const std::vector<SphereLoop>& loops : sphere_faces(circles)) {
      const bool is_cut = !rings_.cuts(node).empty();
      const AxisFrame axes = is_cut ? axes_across(centre, loops[0]) : clear_axes(centre, loops, axes_);
      FaceTemplate face{.surface = SphereSurface{axes, radius}};
      for (const SphereLoop& loop : loops) {
        auto& uses = face.loops.emplace_back();
        for (const SphereArc& arc : loop) uses.push_back(coedges[arc.id]);
      }
      if (coedges.size() == 1) faces_.add_seam(node, joints_.direction(joints_.leaving[node][0]), face);
      face.moments = sphere_moments(centre, radius, loops);
      face.box = box_of(node);
      faces_.add(std::move(face));
    }
  }

  [[nodiscard]] Box3 box_of(std::uint32_t node) const {
    const double r = graph_.nodes[node].radius;
    return {at(node) - Vec3{r, r, r}, at(node) + Vec3{r, r, r}};
  }

  /// Clockwise about the struts: against the faces of these. Behind them the cuts.
  std::vector<SphereCircle> circles_of(std::uint32_t node, std::vector<Coedge>& coedges) const {
    std::vector<SphereCircle> circles;
    std::vector<ArcEnds> ends;
    const auto seen = [&](std::uint32_t vertex) { return unit(geometry_.vertices[vertex] - at(node)); };
    const auto add = [&](std::array<std::uint32_t, 2> vertex, Vec3 axis, double angle, bool is_whole, Coedge coedge) {
      circles.back().arcs.push_back({.axis = axis,
                                     .angle = angle,
                                     .from = seen(vertex[0]),
                                     .to = seen(vertex[1]),
                                     .is_whole = is_whole,
                                     .id = static_cast<std::uint32_t>(coedges.size())});
      coedges.push_back(coedge);
      ends.push_back({vertex, static_cast<std::uint32_t>(circles.size()) - 1,
                      static_cast<std::uint32_t>(circles.back().arcs.size()) - 1});
    };
    for (const Leaving l : joints_.leaving[node]) {
      const Ring& ring = rings_.ring(l);
      const auto count = static_cast<std::uint32_t>(ring.marks.size());
      const bool forward = !rings_.use(l).forward;
      circles.emplace_back();
      for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t k = forward ? i : (count - i) % count,
                            next = forward ? (k + 1) % count : (k + count - 1) % count;
        add({ring.marks[k].vertex, ring.marks[next].vertex}, joints_.direction(l), joints_.end(l).angle, count == 1,
            {.edge = ring.first_edge + (forward ? k : next), .reversed = !forward});
      }
    }
    for (const CutEdge& cut : rings_.cuts(node)) {
      circles.emplace_back();
      const Vec3 axis = unit(cross(seen(cut.vertex[1]), seen(cut.vertex[0])));
      add(cut.vertex, axis, pi / 2, false, {.edge = cut.edge});
      add({cut.vertex[1], cut.vertex[0]}, -axis, pi / 2, false, {.edge = cut.edge, .reversed = true});
    }
    go_on(circles, ends);
    return circles;
  }

  struct ArcEnds {
    std::array<std::uint32_t, 2> vertex{};
    std::uint32_t circle = 0, arc = 0;
  };
  /// From the end of each arc to the one that begins there and turns most to the left, but not back along a cut.
  static void go_on(std::vector<SphereCircle>& circles, const std::vector<ArcEnds>& ends) {
    for (const ArcEnds& from : ends) {
      const SphereArc& arc = circles[from.circle].arcs[from.arc];
      std::array<std::uint32_t, 2> next{from.circle, from.arc};
      double most = -4;  // less than any turn
      for (const ArcEnds& to : ends) {
        const bool is_way_back = to.circle == from.circle && to.vertex[1] == from.vertex[0] && arc.angle == pi / 2;
        if (to.vertex[0] != from.vertex[1] || is_way_back) continue;
        const double turn = turn_between(arc, circles[to.circle].arcs[to.arc]);
        if (turn > most) std::tie(next, most) = std::pair(std::array{to.circle, to.arc}, turn);
      }
      circles[from.circle].next.push_back(next);
    }
  }

  /// No strut ends there: the sphere with its own seam and poles.
  void add_ball(std::uint32_t node) {
    const double r = graph_.nodes[node].radius;
    const Vec3 up{0, 0, r};
    const auto vertex = static_cast<std::uint32_t>(geometry_.vertices.size());
    const auto edge = static_cast<std::uint32_t>(geometry_.edges.size());
    geometry_.vertices.push_back(at(node) - up);
    geometry_.vertices.push_back(at(node) + up);
    geometry_.edges.push_back({.curve = Circle{{at(node), {0, -1, 0}, {1, 0, 0}}, r}, .vertex = {vertex, vertex + 1}});
    for (const std::uint32_t pole : {vertex, vertex + 1})
      geometry_.edges.push_back({.curve = Line{}, .vertex = {pole, pole}, .degenerate = true});
    FaceTemplate face{.surface = SphereSurface{{at(node)}, r}};
    face.loops = {{{.edge = edge + 1}, {.edge = edge}, {.edge = edge + 2}, {.edge = edge, .reversed = true}}};
    face.moments.area = 4 * pi * r * r;
    for (std::size_t i = 0; i < 3; ++i) {
      face.moments.volume_moment[i] = ball_volume(r);
      face.moments.centroid_moment[i] = at(node)[i] * ball_volume(r);
    }
    face.box = box_of(node);
    faces_.add(std::move(face));
  }

  [[nodiscard]] std::vector<Vec3> inner_points_of(std::uint32_t edge, const MeshFineness& fineness) const {
    const EdgeTemplate& e = geometry_.edges[edge];
    const auto* circle = std::get_if<Circle>(&e.curve);
    const int sides = circle == nullptr ? 1 : sides_of(circle->radius, fineness.deflection, fineness.angle);
    return inner_points(e, geometry_, sides);
  }

  [[nodiscard]] Triangulation mesh_of_strut(std::uint32_t s, const MeshFineness& fineness) const {
    const Rings::Seam& seam = rings_.seam(s);
    const Vec3 axis = joints_.direction(2 * s), y = cross(axis, seam.direction);
    const auto inner = [&](std::uint32_t edge, const MeshFineness& f) { return inner_points_of(edge, f); };
    std::array<std::vector<RingPoint>, 2> rings;
    for (const std::uint32_t end : {0u, 1u}) {
      std::vector<Vec3> points;
      for (const Coedge& use : rings_.around(2 * s + end, seam.vertex[end]))
        faces_.append_points(use, inner, fineness, points);
      // The second ring runs the other way about the axis.
      if (end == 1) std::reverse(points.begin() + 1, points.end());
      for (const Vec3& p : points) {
        const Vec3 v = p - at(graph_.struts[s].node[0]);
        const double turn = std::atan2(dot(v, y), dot(v, seam.direction));
        rings[end].push_back({p, rings[end].empty() ? 0 : turn < 0 ? turn + 2 * pi : turn});
      }
      rings[end].push_back({points.front(), 2 * pi});
    }
    return strut_mesh(rings[0], rings[1]);
  }

  [[nodiscard]] double pieces_volume() const {
    long double sum = 0;
    for (std::uint32_t n = 0; n < graph_.nodes.size(); ++n) {
      const double ball = graph_.nodes[n].radius;
      if (ball == 0) continue;
      sum += ball_volume(ball);
      for (const Leaving l : joints_.leaving[n]) sum -= cap_volume(ball, ball - joints_.end(l).along);
    }
    for (std::uint32_t s = 0; s < graph_.struts.size(); ++s) {
      if (joints_.is_swallowed[s]) continue;
      const auto& [a, b] = joints_.ends[s];
      const double length = norm(at(graph_.struts[s].node[1]) - at(graph_.struts[s].node[0])) - a.along - b.along;
      sum += pi * length / 3 * (a.radius * a.radius + a.radius * b.radius + b.radius * b.radius);
    }
    return static_cast<double>(sum);
  }

  const Joints& joints_;
  const BeamGraph& graph_;
  const LatticeOptions& options_;
  BeamFaces faces_;
  Template& geometry_ = faces_.geometry();
  Rings rings_;
  AxisFrame axes_;
};

/// Vertices, edges and faces as they are stored, with the division of circles that automatic balls bring.
bool fits_in_memory(const BeamGraph& graph, const LatticeOptions& options, DiagnosticSink& sink) {
  const std::uint64_t of_strut = 8 * sizeof(EdgeTemplate) + 3 * sizeof(FaceTemplate);
  const std::uint64_t need = graph.struts.size() * of_strut * (options.mesh ? 2 : 1),
                      budget = options.run.max_memory_bytes;
  if (need <= budget) return true;
  sink.report({.code = Code::limit_memory, .args = {std::to_string(budget >> 20) + " MiB"}});
  return false;
}

}  // namespace

std::optional<Body> beam_graph_body(const Joints& joints, const LatticeOptions& options, DiagnosticSink& sink) {
  if (!fits_in_memory(joints.graph, options, sink)) return {};
  const auto stopped = [&] {
    if (!options.run.should_stop()) return false;
    sink.report({.code = options.run.out_of_time() ? Code::limit_time : Code::cancelled});
    return true;
  };
  BeamBody body(joints, options);
  if (!body.make_faces()) return stopped(), std::nullopt;
  if (!body.make_mesh()) {
    if (stopped()) return {};
    throw Standard_Failure("the circles of a ball could not be divided finely enough");
  }
  return body.finish();
}

}  // namespace meso::brep
