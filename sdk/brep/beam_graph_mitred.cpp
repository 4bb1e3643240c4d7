// SPDX-License-Identifier: Apache-2.0
#include "beam_graph_mitred.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "beam_graph_ball_faces.hpp"
#include "beam_graph_faces.hpp"
#include "beam_graph_joints.hpp"
#include "beam_graph_mesh.hpp"
#include "beam_graph_mitre_edges.hpp"
#include "beam_graph_mitre_mesh.hpp"
#include "beam_graph_rings.hpp"
#include "beam_graph_sphere.hpp"
#include "lattice/parallel.hpp"
#include "meso/base/number.hpp"
#include "occt.hpp"

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;

Vec3 unit(Vec3 v) { return v / norm(v); }
Vec3 across(Vec3 v) { return unit(cross(v, std::fabs(v.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})); }

class MitredBody {
 public:
  MitredBody(const Joints& joints, const LatticeOptions& options)
      : joints_(joints), graph_(joints.graph), options_(options), faces_(joints.graph), strut_(graph_.struts.size()) {}

  bool make(std::string& why) {
    if (!find_miters(why) || !make_edges(why)) return false;
    for (std::uint32_t n = 0; n < graph_.nodes.size(); ++n) {
      faces_.begin(n);
      if (!add_faces_of_ball(n, why)) return false;
    }
    for (std::uint32_t s = 0; s < graph_.struts.size(); ++s) {
      faces_.begin(graph_.struts[s].node[0]);
      add_strut(s);
    }
    return is_closed(why);
  }

  bool find_miters(std::string& why) {
    for (std::uint32_t n = 0; n < graph_.nodes.size(); ++n) {
      if (joints_.leaving[n].empty()) {
        why = "a ball has no strut";
        return false;
      }
      std::vector<Stub> stubs;
      for (const Leaving l : joints_.leaving[n]) stubs.push_back(stub_of(l));
      miters_.emplace_back(graph_.nodes[n].radius, std::move(stubs));
    }
    if (!in_parallel(miters_.size(), options_.run, [&](std::size_t, std::size_t n) { return miters_[n].find(); })) {
      why = "struts of a node grow into each other";
      return false;
    }
    for (std::uint32_t s = 0; s < graph_.struts.size(); ++s) {
      double taken = 0;
      for (const Leaving l : {2 * s, 2 * s + 1}) taken += farthest(l);
      if (taken > (1 - 1e-3) * length_of(s)) {
        why = "a strut does not run free between its nodes";
        return false;
      }
    }
    return true;
  }
  /// False: edges could not be divided finely enough, or the run was to stop.
  bool make_mesh() {
    return faces_.mesh(
        options_, [&](std::uint32_t edge, const MeshFineness& fineness) { return inner_points_of(edge, fineness); },
        [&](std::uint32_t strut, const MeshFineness& fineness) { return mesh_of_strut(strut, fineness); });
  }

  Body finish() { return faces_.body(); }

 private:
  [[nodiscard]] Vec3 at(std::uint32_t node) const { return graph_.nodes[node].position; }
  [[nodiscard]] std::string place(std::uint32_t node) const {
    return "(" + format_number(at(node).x) + " " + format_number(at(node).y) + " " + format_number(at(node).z) + ")";
  }
  [[nodiscard]] double length_of(std::uint32_t s) const {
    return norm(at(graph_.struts[s].node[1]) - at(graph_.struts[s].node[0]));
  }
  /// Which stub of its node an end is.
  [[nodiscard]] std::size_t place_of(Leaving l) const {
    const auto& leaving = joints_.leaving[joints_.node(l)];
    return static_cast<std::size_t>(std::ranges::find(leaving, l) - leaving.begin());
  }

  [[nodiscard]] Stub stub_of(Leaving l) const {
    const BeamGraph::Strut& strut = graph_.struts[l / 2];
    const double growth = (strut.radius[1] - strut.radius[0]) / length_of(l / 2);
    Stub stub{.axis = joints_.direction(l), .radius = strut.radius[l % 2], .growth = l % 2 == 0 ? growth : -growth};
    stub.x = across(joints_.direction(l - l % 2));
    stub.y = cross(stub.axis, stub.x);
    stub.leaves_ball = leave_ball(graph_.nodes[joints_.node(l)].radius, stub.radius, stub.growth).along;
    return stub;
  }
  [[nodiscard]] double farthest(Leaving l) const { return miters_[joints_.node(l)].farthest(place_of(l)); }

  [[nodiscard]] const std::vector<Mitre>& mitres(Leaving l) const {
    return miters_[joints_.node(l)].mitres()[place_of(l)];
  }
  /// A turn about the first end of a strut as one about the end, and back: that of the second runs the other way.
  static double turn_at(Leaving l, double turn) {
    const double at = std::fmod(turn, 2 * pi);
    return l % 2 == 0 || at == 0 ? at : 2 * pi - at;
  }

  /// In the widest gap between the corners of both ends where lines are in sight without a break; none: -1.
  [[nodiscard]] double seam_of(std::uint32_t s) const {
    std::vector<double> turns;
    for (const Leaving l : {2 * s, 2 * s + 1})
      for (const Mitre& m : mitres(l))
        if (m.to - m.from < 2 * pi) turns.insert(turns.end(), {turn_at(l, m.from), turn_at(l, m.to)});
    if (turns.empty()) return 0;
    std::ranges::sort(turns);
    double widest = 1e-6, best = -1;
    for (std::size_t i = 0; i < turns.size(); ++i) {
      const double gap = (i + 1 < turns.size() ? turns[i + 1] : turns[0] + 2 * pi) - turns[i];
      const double middle = std::fmod(turns[i] + gap / 2, 2 * pi);
      if (gap <= widest + 1e-9 || count_at(2 * s, middle) + count_at(2 * s + 1, middle) != 2) continue;
      widest = gap;
      best = middle;
    }
    return best;
  }
  /// How many mitres a line has.
  [[nodiscard]] std::ptrdiff_t count_at(Leaving l, double turn) const {
    const double at = turn_at(l, turn);
    return std::ranges::count_if(mitres(l), [&](const Mitre& m) {
      return (m.from <= at && at <= m.to) || (m.from <= at + 2 * pi && at + 2 * pi <= m.to);
    });
  }

  bool make_edges(std::string& why) {
    for (std::uint32_t s = 0; s < strut_.size(); ++s) strut_[s].seam = seam_of(s);
    for (std::uint32_t n = 0; n < graph_.nodes.size(); ++n) {
      std::vector<double> seams;
      for (const Leaving l : joints_.leaving[n]) {
        if (strut_[l / 2].seam < 0) {
          why = "a strut has no place for a seam";
          return false;
        }
        seams.push_back(turn_at(l, strut_[l / 2].seam));
      }
      auto edges = mitre_edges(miters_[n], at(n), seams, geometry_, arcs_);
      if (!edges) {
        why = "struts at the node " + place(n) + " do not end at each other alike";
        return false;
      }
      rings_.push_back(std::move(*edges));
    }
    for (std::uint32_t s = 0; s < strut_.size(); ++s) {
      const auto vertex = [&](Leaving l) {
        const Coedge& first = ring(l).front();
        return geometry_.edges[first.edge].vertex[first.reversed ? 1 : 0];
      };
      const std::array ends{vertex(2 * s), vertex(2 * s + 1)};
      const Vec3 from = geometry_.vertices[ends[0]], to = geometry_.vertices[ends[1]];
      strut_[s].edge = static_cast<std::uint32_t>(geometry_.edges.size());
      geometry_.edges.push_back({.curve = Line{from, unit(to - from)}, .vertex = ends});
      arcs_.resize(geometry_.edges.size());
    }
    return true;
  }
  /// From the seam around the strut, counter-clockwise about its way from the node.
  [[nodiscard]] const std::vector<Coedge>& ring(Leaving l) const { return rings_[joints_.node(l)].around[place_of(l)]; }

  void add_strut(std::uint32_t s) {
    const auto& [node, radius] = graph_.struts[s];
    const Vec3 axis = joints_.direction(2 * s), from = at(node[0]), to = at(node[1]);
    const Vec3 side = stub(2 * s).outward(strut_[s].seam);
    const double length = length_of(s), half_angle = std::atan(std::fabs(radius[1] - radius[0]) / length);
    FaceTemplate face;
    if (radius[0] == radius[1])
      face.surface = CylinderSurface{{from, axis, side}, radius[0]};
    else if (radius[0] < radius[1])
      face.surface = ConeSurface{{from, axis, side}, radius[0], half_angle};
    else
      face.surface = ConeSurface{{to, -axis, side}, radius[1], half_angle};
    std::vector<Coedge>& loop = face.loops.emplace_back(ring(2 * s));
    loop.push_back({.edge = strut_[s].edge});
    loop.insert(loop.end(), ring(2 * s + 1).begin(), ring(2 * s + 1).end());
    loop.push_back({.edge = strut_[s].edge, .reversed = true});
    face.moments = moments_of(s);
    for (const std::size_t end : {0u, 1u}) {
      Vec3 reach;
      for (std::size_t i = 0; i < 3; ++i) reach[i] = radius[end] * std::sqrt(std::max(0.0, 1 - axis[i] * axis[i]));
      face.box.extend(at(node[end]) - reach);
      face.box.extend(at(node[end]) + reach);
    }
    faces_.add(std::move(face), s);
  }
  [[nodiscard]] const Stub& stub(Leaving l) const { return miters_[joints_.node(l)].stubs()[place_of(l)]; }

  /// Of all of the strut from node to node, less what is hidden at both ends.
  [[nodiscard]] FaceMoments moments_of(std::uint32_t s) const {
    FaceMoments m;
    const Mitre all{0, 2 * pi};
    add_lines(
        2 * s, all, [length = length_of(s)](double) { return length; }, m, 1);
    for (const Leaving l : {2 * s, 2 * s + 1})
      for (const Mitre& mitre : mitres(l)) {
        const NodeMiters& node = miters_[joints_.node(l)];
        const std::size_t stub = place_of(l);
        add_lines(
            l, mitre, [&](double turn) { return node.along(stub, mitre, turn); }, m, mitre.goes_in ? 1 : -1);
      }
    return m;
  }

  /// Gauss's rule: along the strut from its node on, where it is exact, and around it. Mitres may begin and end along a
  /// line: turns are denser there.
  template <typename Along>
  void add_lines(Leaving l, const Mitre& range, const Along& along, FaceMoments& m, double sign) const {
    constexpr std::array<double, 3> node{-0.7745966692414834, 0, 0.7745966692414834};
    constexpr std::array<double, 3> weight{5.0 / 9, 8.0 / 9, 5.0 / 9};
    constexpr std::array<double, 4> fine{0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                         0.9602898564975363};
    constexpr std::array<double, 4> share{0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                          0.1012285362903763};
    const Stub& own = stub(l);
    const Vec3 from = at(joints_.node(l));
    const double sweep = range.to - range.from;
    const int parts = 2 + static_cast<int>(std::ceil(sweep / (pi / 16)));
    for (int part = 0; part < parts; ++part)
      for (std::size_t j = 0; j < 8; ++j) {
        const double w = (2 * part + 1 + (j % 2 == 0 ? fine[j / 2] : -fine[j / 2])) / (2 * parts);
        const double turn = range.from + sweep * (1 - std::cos(pi * w)) / 2;
        const double around = share[j / 2] / (2 * parts) * sweep * pi / 2 * std::sin(pi * w);
        const double length = along(turn);
        const Vec3 e = own.outward(turn), normal = e - own.growth * own.axis;
        for (std::size_t k = 0; k < 3; ++k) {
          const double t = length / 2 * (1 + node[k]), r = own.radius + own.growth * t;
          const double ds = sign * weight[k] * length / 2 * around * r;
          const Vec3 p = from + r * e + t * own.axis;
          m.area += norm(normal) * ds;
          for (std::size_t i = 0; i < 3; ++i) {
            m.vector_area[i] += normal[i] * ds;
            m.volume_moment[i] += p[i] * normal[i] * ds;
            m.centroid_moment[i] += p[i] * p[i] / 2 * normal[i] * ds;
          }
        }
      }
  }

  bool add_faces_of_ball(std::uint32_t n, std::string& why) {
    const Vec3 centre = at(n);
    const double radius = graph_.nodes[n].radius;
    const auto seen = [&](std::uint32_t vertex) { return unit(geometry_.vertices[vertex] - centre); };
    std::vector<SphereArc> arcs;
    std::vector<std::array<std::uint32_t, 2>> ends;
    for (const BallArc& a : rings_[n].on_ball) {
      const auto& vertex = geometry_.edges[a.edge].vertex;
      const Stub& s = miters_[n].stubs()[a.stub];
      arcs.push_back({.axis = s.axis,
                      .angle = std::atan2(s.radius + s.growth * s.leaves_ball, s.leaves_ball),
                      .from = seen(vertex[1]),
                      .to = seen(vertex[0]),
                      .is_whole = vertex[0] == vertex[1],
                      .id = a.edge});
      ends.push_back({vertex[1], vertex[0]});
    }
    std::vector<SphereLoop> loops;
    std::vector<bool> taken(arcs.size(), false);
    for (std::size_t first = 0; first < arcs.size(); ++first) {
      if (taken[first]) continue;
      SphereLoop& loop = loops.emplace_back();
      for (std::size_t a = first; !taken[a];) {
        taken[a] = true;
        loop.push_back(arcs[a]);
        std::size_t next = arcs.size();
        double most = -4;  // less than any turn
        for (std::size_t b = 0; b < arcs.size(); ++b) {
          if (ends[b][0] != ends[a][1]) continue;
          const double turn = turn_between(arcs[a], arcs[b]);
          if (turn <= most) continue;
          most = turn;
          next = b;
        }
        if (next == arcs.size() || (taken[next] && next != first)) {
          why = "what struts leave of a ball has no border";
          return false;
        }
        a = next;
      }
    }
    std::vector<UnitLoop> polygons;
    for (const SphereLoop& loop : loops) {
      auto& polygon = polygons.emplace_back();
      for (const SphereArc& arc : loop) {
        polygon.push_back(arc.from);
        std::vector<Vec3> inner = inner_points(geometry_.edges[arc.id], geometry_, 32);
        for (auto p = inner.rbegin(); p != inner.rend(); ++p) polygon.push_back(unit(*p - centre));
      }
    }
    for (const auto& of_face : loops_of_faces(polygons)) {
      std::vector<SphereLoop> own;
      std::vector<UnitLoop> borders;
      for (const std::size_t l : of_face) {
        own.push_back(loops[l]);
        borders.push_back(polygons[l]);
      }
      const auto axes = axes_off(centre, borders);
      FaceTemplate face{.surface = SphereSurface{axes ? *axes : clear_axes(centre, own, axes_), radius}};
      for (const SphereLoop& loop : own) {
        auto& uses = face.loops.emplace_back();
        for (const SphereArc& arc : loop) uses.push_back({.edge = arc.id, .reversed = true});
      }
      if (arcs.size() == 1) faces_.add_seam(n, arcs[0].axis, face);
      face.moments = sphere_moments(centre, radius, own);
      const Vec3 r{radius, radius, radius};
      face.box = {centre - r, centre + r};
      faces_.add(std::move(face));
    }
    return true;
  }

  /// By the faces alone: as vectors they add up to nothing, and enclose one volume whatever is counted along.
  bool is_closed(std::string& why) const {
    for (const auto& faces : faces_.solids()) {
      FaceMoments sum;
      Box3 box;
      for (const std::uint32_t f : faces) {
        const FaceMoments& m = geometry_.faces[f].moments;
        sum.area += m.area;
        sum.vector_area += m.vector_area;
        sum.volume_moment += m.volume_moment;
        box.extend(geometry_.faces[f].box.min);
        box.extend(geometry_.faces[f].box.max);
      }
      if (faces.empty()) continue;
      const Vec3 v = sum.volume_moment;
      const double largest = std::max({norm(box.min), norm(box.max), 1.0});
      const double off = std::max({std::fabs(v.x - v.y), std::fabs(v.y - v.z), largest * norm(sum.vector_area)});
      if (v.x > 0 && off <= 1e-7 * v.x) continue;
      why = "faces enclose " + format_number(v.x) + ", " + format_number(v.y) + " and " + format_number(v.z) + " mm3";
      return false;
    }
    return true;
  }

  [[nodiscard]] std::vector<Vec3> inner_points_of(std::uint32_t number, const MeshFineness& fineness) const {
    const EdgeTemplate& edge = geometry_.edges[number];
    if (edge.degenerate || std::holds_alternative<Line>(edge.curve)) return {};
    if (const auto* circle = std::get_if<Circle>(&edge.curve))
      return inner_points(edge, geometry_, sides_of(circle->radius, fineness.deflection, fineness.angle));
    const MitreArc& arc = arcs_[number];
    const int sides = sides_of(arc.radius, fineness.deflection, fineness.angle);
    return arc.points(std::max(1, static_cast<int>(std::ceil(sides * arc.sweep / (2 * pi)))));
  }

  [[nodiscard]] Triangulation mesh_of_strut(std::uint32_t s, const MeshFineness& fineness) const {
    const Stub& own = stub(2 * s);
    const Vec3 x = own.outward(strut_[s].seam);
    const MitredStrut strut{
        at(graph_.struts[s].node[0]),      x, cross(own.axis, x), own.axis, own.radius, own.growth, farthest(2 * s),
        length_of(s) - farthest(2 * s + 1)};
    const auto inner = [&](std::uint32_t edge, const MeshFineness& f) { return inner_points_of(edge, f); };
    std::array<std::vector<Vec3>, 2> borders;
    for (const std::uint32_t end : {0u, 1u})
      for (const Coedge& use : ring(2 * s + end)) faces_.append_points(use, inner, fineness, borders[end]);
    std::reverse(borders[1].begin() + 1, borders[1].end());  // it runs the other way about the axis
    return mitred_mesh(strut, borders);
  }

  const Joints& joints_;
  const BeamGraph& graph_;
  const LatticeOptions& options_;
  BeamFaces faces_;
  Template& geometry_ = faces_.geometry();
  std::vector<NodeMiters> miters_;  ///< by node
  std::vector<NodeEdges> rings_;    ///< by node
  std::vector<MitreArc> arcs_;      ///< by edge
  struct StrutSeam {
    double seam = 0;  ///< turn about the first end
    std::uint32_t edge = 0;
  };
  std::vector<StrutSeam> strut_;
  AxisFrame axes_;
};

}  // namespace

std::optional<Body> mitred_body(const BeamGraph& graph, const LatticeOptions& options, SnappedRadii& snapped,
                                std::string& why) {
  constexpr std::uint64_t of_strut = 16 << 10;  // bytes: curves with dozens of poles
  if (graph.struts.size() > options.run.max_memory_bytes / of_strut) {
    why = "curves between so many struts need too much memory";
    return {};
  }
  const auto joints = joints_of(graph, snapped, why, Meeting::beyond_balls);
  if (!joints) return {};
  MitredBody body(*joints, options);
  if (!body.make(why)) return {};
  if (!body.make_mesh()) {
    why = "a ball cannot be meshed";
    return {};
  }
  return body.finish();
}

bool struts_run_free(const BeamGraph& graph, const RunOptions& run) {
  SnappedRadii snapped;
  std::string why;
  const auto joints = joints_of(graph, snapped, why, Meeting::beyond_balls);
  return joints && MitredBody(*joints, {.run = run}).find_miters(why);
}

}  // namespace meso::brep
