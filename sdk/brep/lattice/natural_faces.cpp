// SPDX-License-Identifier: Apache-2.0
#include "lattice/natural_faces.hpp"

#include <map>
#include <numbers>
#include <optional>

#include "meso/brep/instance_map.hpp"
#include "meso/brep/placement.hpp"

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;

Index3 minus(const Index3& a, const Index3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

bool same_direction(Vec3 a, Vec3 b) { return norm(a - b) < 1e-9; }

/// Whether two surfaces, `b` moved by `shift`, are the same set of points with the same parameters up to the origin.
struct SameSurface {
  Vec3 shift;
  double tolerance;

  bool operator()(const Plane& a, const Plane& b) const {
    return same_direction(a.frame.z, b.frame.z) &&
           std::fabs(dot(b.frame.origin + shift - a.frame.origin, a.frame.z)) < tolerance;
  }
  bool operator()(const CylinderSurface& a, const CylinderSurface& b) const {
    return same_axis(a.frame, b.frame) && std::fabs(a.radius - b.radius) < tolerance;
  }
  bool operator()(const ConeSurface& a, const ConeSurface& b) const {
    if (!same_axis(a.frame, b.frame) || std::fabs(a.half_angle - b.half_angle) > 1e-9) return false;
    const double along = dot(b.frame.origin + shift - a.frame.origin, a.frame.z);
    return std::fabs(a.radius + along * std::tan(a.half_angle) - b.radius) < tolerance;
  }
  bool operator()(const SphereSurface& a, const SphereSurface& b) const {
    return same_direction(a.frame.z, b.frame.z) && same_direction(a.frame.x, b.frame.x) &&
           norm(b.frame.origin + shift - a.frame.origin) < tolerance && std::fabs(a.radius - b.radius) < tolerance;
  }
  template <typename A, typename B>
  bool operator()(const A&, const B&) const {
    return false;  // different kinds; tori and B-splines stay in pieces
  }

 private:
  [[nodiscard]] bool same_axis(const AxisFrame& a, const AxisFrame& b) const {
    const Vec3 d = b.origin + shift - a.origin;
    return same_direction(a.z, b.z) && same_direction(a.x, b.x) && norm(d - dot(d, a.z) * a.z) < tolerance;
  }
};

/// Longitude and height (plane: two coordinates) of a point. Longitudes are in (-pi, pi].
struct Chart {
  AxisFrame frame;
  bool periodic = false;

  explicit Chart(const Surface& surface) : periodic(!std::holds_alternative<Plane>(surface)) {
    std::visit(
        [&](const auto& s) {
          if constexpr (requires { s.frame; }) frame = s.frame;
        },
        surface);
  }
  [[nodiscard]] std::array<double, 2> operator()(Vec3 p) const {
    const Vec3 d = p - frame.origin, y = cross(frame.z, frame.x);
    if (!periodic) return {dot(d, frame.x), dot(d, y)};
    return {std::atan2(dot(d, y), dot(d, frame.x)), dot(d, frame.z)};
  }
};

/// One use of an edge by one part, linked into loops that survive the removal of edges.
struct HalfEdge {
  Coedge use;  // offset counts from the cell of the owner
  std::size_t part = 0, next = 0, previous = 0;
  bool removed = false;
};

/// Joins the parts of one face: removes the edges between them and keeps as a seam what the surface cannot do without.
class Join {
 public:
  Join(const Quotient& quotient, const NaturalFace& natural)
      : quotient_(quotient), natural_(natural), chart_(first().surface) {
    for (std::size_t p = 0; p < natural.parts.size(); ++p)
      for (const auto& loop : face(p).loops) add_loop(p, loop);
    pair_up();
  }

  /// The first way of keeping a seam (none is tried first) with which every loop closes in the chart.
  [[nodiscard]] std::optional<std::vector<std::vector<Coedge>>> loops() const {
    if (pairs_.empty()) return {};
    for (const double seam : seams()) {
      const std::vector<HalfEdge> edges = without_pairs(seam);
      if (auto found = closed_loops(edges)) return found;
    }
    return {};
  }

 private:
  static constexpr double no_seam = 99;

  [[nodiscard]] const FaceTemplate& face(std::size_t part) const {
    return quotient_.geometry->faces[quotient_.kinds[0].faces[natural_.parts[part].piece].face];
  }
  [[nodiscard]] const FaceTemplate& first() const { return face(0); }
  [[nodiscard]] bool degenerate(const HalfEdge& e) const { return quotient_.geometry->edges[e.use.edge].degenerate; }

  void add_loop(std::size_t part, const std::vector<Coedge>& loop) {
    const std::size_t begin = edges_.size(), count = loop.size();
    for (std::size_t i = 0; i < count; ++i) {
      HalfEdge edge{
          .use = loop[i], .part = part, .next = begin + (i + 1) % count, .previous = begin + (i + count - 1) % count};
      edge.use.offset = loop[i].offset + natural_.parts[part].offset;
      edges_.push_back(edge);
    }
  }
  void pair_up() {
    std::map<std::pair<std::uint32_t, Index3>, std::vector<std::size_t>> uses;
    for (std::size_t e = 0; e < edges_.size(); ++e)
      if (!degenerate(edges_[e])) uses[{edges_[e].use.edge, edges_[e].use.offset}].push_back(e);
    for (const auto& [edge, two] : uses)
      if (two.size() == 2 && edges_[two[0]].part != edges_[two[1]].part) pairs_.emplace_back(two[0], two[1]);
  }

  /// The longitude of an edge that runs along a meridian or ruling, else `no_seam`.
  [[nodiscard]] double longitude(const Coedge& use) const {
    const std::vector<Vec3> points = along(use);
    const double u = chart_(points[points.size() / 2])[0];
    for (const Vec3 p : points)
      if (std::fabs(std::remainder(chart_(p)[0] - u, 2 * pi)) > 1e-6) return no_seam;
    return std::remainder(u, 2 * pi);
  }
  [[nodiscard]] std::vector<double> seams() const {
    std::vector<double> found{no_seam};
    if (!chart_.periodic) return found;
    for (const auto& [a, b] : pairs_) {
      const double u = longitude(edges_[a].use);
      const bool known = std::any_of(found.begin(), found.end(), [&](double v) { return std::fabs(u - v) < 1e-6; });
      // Where a sphere's parameters begin, its seam must be; a cylinder can be turned.
      const bool possible = !std::holds_alternative<SphereSurface>(first().surface) || std::fabs(u) < 1e-6;
      if (!known && possible) found.push_back(u);
    }
    return found;
  }

  [[nodiscard]] std::vector<HalfEdge> without_pairs(double seam) const {
    std::vector<HalfEdge> edges = edges_;
    const auto link = [&](std::size_t a, std::size_t b) {
      edges[a].next = b;
      edges[b].previous = a;
    };
    for (const auto& [a, b] : pairs_) {
      if (seam != no_seam && std::fabs(longitude(edges[a].use) - seam) < 1e-6) continue;
      const std::size_t before_a = edges[a].previous, after_a = edges[a].next;
      const std::size_t before_b = edges[b].previous, after_b = edges[b].next;
      if (after_a != b) link(before_b, after_a);  // else the edge ended in nothing there
      if (after_b != a) link(before_a, after_b);
      edges[a].removed = edges[b].removed = true;
    }
    return edges;
  }

  [[nodiscard]] std::vector<Vec3> along(const Coedge& use) const {
    std::vector<Vec3> points = quotient_.samples[use.edge];
    const Vec3 shift = cell_origin(*quotient_.geometry, use.offset);
    for (Vec3& p : points) p += shift;
    if (use.reversed) std::reverse(points.begin(), points.end());
    return points;
  }

  struct Winding {
    double turns = 0, area = 0;
  };
  /// Total turn about the axis, and area in the chart. At a pole the loop turns all the way that is left.
  [[nodiscard]] Winding winding(const std::vector<Coedge>& loop) const {
    Winding result;
    std::vector<std::array<double, 2>> path;
    double pole = 0;  // direction of a pending turn at a pole
    const auto advance = [&](std::array<double, 2> q) {
      if (!path.empty() && chart_.periodic) {
        double step = std::remainder(q[0] - path.back()[0], 2 * pi);
        if (pole != 0 && (std::fabs(step) < 1e-3 || step * pole < 0)) step += 2 * pi * pole;
        q[0] = path.back()[0] + step;
      }
      pole = 0;
      path.push_back(q);
    };
    // Begin with a real edge, so that a pole has something before and after it.
    std::size_t start = 0;
    while (start < loop.size() && quotient_.geometry->edges[loop[start].edge].degenerate) ++start;
    if (start == loop.size()) return {.turns = 1, .area = 0};
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Coedge& use = loop[(start + i) % loop.size()];
      const EdgeTemplate& edge = quotient_.geometry->edges[use.edge];
      if (edge.degenerate) {
        const Vec3 at = quotient_.geometry->vertices[edge.vertex[0]] +
                        cell_origin(*quotient_.geometry, use.offset + edge.vertex_offset[0]);
        const double up = chart_(at)[1] > path.back()[1] ? 1 : -1;
        pole = first().reversed ? up : -up;
        continue;
      }
      for (const Vec3 p : along(use)) advance(chart_(p));
    }
    const std::array<double, 2> begin = path.front();
    advance(begin);
    if (chart_.periodic) result.turns = (path.back()[0] - begin[0]) / (2 * pi);
    for (std::size_t i = 0; i + 1 < path.size(); ++i)
      result.area += (path[i + 1][0] - path[i][0]) * (path[i + 1][1] + path[i][1]) / -2;
    return result;
  }

  [[nodiscard]] std::optional<std::vector<std::vector<Coedge>>> closed_loops(const std::vector<HalfEdge>& edges) const {
    std::vector<std::pair<double, std::vector<Coedge>>> found;
    std::vector<bool> seen(edges.size());
    for (std::size_t e = 0; e < edges.size(); ++e) {
      if (edges[e].removed || seen[e]) continue;
      std::vector<Coedge> loop;
      bool at_pole = false;
      for (std::size_t i = e; !seen[i]; i = edges[i].next) {
        seen[i] = true;
        const bool pole = degenerate(edges[i]);
        if (!(pole && at_pole)) loop.push_back(edges[i].use);  // several parts of one pole are one
        at_pole = pole;
      }
      if (loop.size() > 1 && at_pole && quotient_.geometry->edges[loop.front().edge].degenerate) loop.pop_back();
      const Winding w = winding(loop);
      if (std::fabs(w.turns) > 0.1) return {};
      found.emplace_back(std::fabs(w.area), std::move(loop));
    }
    if (found.empty()) return {};
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<std::vector<Coedge>> loops;
    loops.reserve(found.size());
    for (auto& [area, loop] : found) loops.push_back(std::move(loop));
    return loops;
  }

  const Quotient& quotient_;
  const NaturalFace& natural_;
  Chart chart_;
  std::vector<HalfEdge> edges_;
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;
};

/// The pieces that are one face with piece `start`; none if the face meets itself a period away, and so never ends.
std::optional<NaturalFace> parts_of(const Quotient& quotient, std::uint32_t start) {
  const CellKind& kind = quotient.kinds[0];
  const Template& geometry = *quotient.geometry;
  std::map<std::uint32_t, Index3> at{{start, {}}};
  NaturalFace natural{.face = 0, .parts = {{{}, start}}};
  for (std::size_t done = 0; done < natural.parts.size(); ++done) {
    const auto [offset, piece] = natural.parts[done];
    const FaceTemplate& face = geometry.faces[kind.faces[piece].face];
    for (const auto& loop : face.loops)
      for (const Coedge& use : loop) {
        if (geometry.edges[use.edge].degenerate) continue;
        for (const EdgeUse& other : quotient.uses[use.edge]) {
          if (other.kind != 0 || kind.faces[other.face].axis >= 0 || other.reversed == use.reversed) continue;
          const Index3 cell = offset + use.offset + other.face_cell;
          const FaceTemplate& neighbour = geometry.faces[kind.faces[other.face].face];
          const SameSurface same{cell_origin(geometry, minus(cell, offset)), quotient.tolerance};
          if (face.reversed != neighbour.reversed || !std::visit(same, face.surface, neighbour.surface)) continue;
          const auto [known, fresh] = at.emplace(other.face, cell);
          if (fresh) natural.parts.push_back({cell, other.face});
          if (known->second != cell) return {};
        }
      }
  }
  if (natural.parts.size() < 2) return {};
  return natural;
}

FaceMoments moved(const FaceMoments& m, Vec3 t) {
  const Vec3 &v = m.volume_moment, &a = m.vector_area, &c = m.centroid_moment;
  FaceMoments result = m;
  for (std::size_t i = 0; i < 3; ++i) {
    result.volume_moment[i] = v[i] + t[i] * a[i];
    result.centroid_moment[i] = c[i] + t[i] * (v[i] + t[i] / 2 * a[i]);
  }
  return result;
}

void append(Triangulation& mesh, const Triangulation& part, const Index3& offset) {
  const auto base = static_cast<std::uint32_t>(mesh.points.size());
  for (const MeshPoint& p : part.points) mesh.points.push_back({p.point, p.offset + offset});
  for (const auto& t : part.triangles) mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
}

FaceTemplate joined(const Quotient& quotient, const NaturalFace& natural, std::vector<std::vector<Coedge>> loops) {
  const Template& geometry = *quotient.geometry;
  const auto face_of = [&](const NaturalFace::Part& part) -> const FaceTemplate& {
    return geometry.faces[quotient.kinds[0].faces[part.piece].face];
  };
  const FaceTemplate& first = face_of(natural.parts.front());
  FaceTemplate face{.surface = first.surface, .reversed = first.reversed, .loops = std::move(loops)};
  for (const NaturalFace::Part& part : natural.parts) {
    const FaceTemplate& piece = face_of(part);
    const Vec3 shift = cell_origin(geometry, part.offset);
    const FaceMoments m = moved(piece.moments, shift);
    face.moments.area += m.area;
    face.moments.volume_moment += m.volume_moment;
    face.moments.vector_area += m.vector_area;
    face.moments.centroid_moment += m.centroid_moment;
    face.box.extend(piece.box.min + shift);
    face.box.extend(piece.box.max + shift);
    append(face.mesh, piece.mesh, part.offset);
  }
  return face;
}

}  // namespace

void find_natural_faces(Quotient& quotient) {
  const CellKind& kind = quotient.kinds[0];
  quotient.part_of.resize(kind.faces.size());
  std::vector<bool> seen(kind.faces.size());
  for (std::uint32_t f = 0; f < kind.faces.size(); ++f) {
    if (seen[f] || kind.faces[f].axis >= 0) continue;
    std::optional<NaturalFace> natural = parts_of(quotient, f);
    if (!natural) continue;
    for (const NaturalFace::Part& part : natural->parts) seen[part.piece] = true;
    std::optional<std::vector<std::vector<Coedge>>> loops = Join(quotient, *natural).loops();
    if (!loops) continue;
    FaceTemplate face = joined(quotient, *natural, std::move(*loops));
    natural->face = static_cast<std::uint32_t>(quotient.geometry->faces.size());
    quotient.geometry->faces.push_back(std::move(face));
    for (std::size_t p = 0; p < natural->parts.size(); ++p)
      quotient.part_of[natural->parts[p].piece] = {.natural = static_cast<std::int32_t>(quotient.naturals.size()),
                                                   .offset = natural->parts[p].offset,
                                                   .owner = p == 0};
    quotient.naturals.push_back(std::move(*natural));
  }
}

}  // namespace meso::brep
