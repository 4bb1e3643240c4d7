// SPDX-License-Identifier: Apache-2.0
#include "realise_graph_step.hpp"

#include <IntCurvesFace_ShapeIntersector.hxx>
#include <algorithm>
#include <cmath>
#include <deque>

#include "beam_graph_mitred.hpp"
#include "meso/base/number.hpp"
#include "meso/brep/measure.hpp"
#include "point_in_solid.hpp"
#include "point_within.hpp"
#include "realise_beam_graph.hpp"
#include "realise_part.hpp"
#include "step_telling.hpp"

namespace meso::brep {
namespace {

constexpr std::uint64_t few_cells = 8;  ///< are joined one by one if they must
/// Kinds of box that may be had in the time that the boolean of the graph has taken.
constexpr FusedLimit few_fused{200, false};

/// Beams that would keep apart if they were thinner: what is told of them. Empty: that is not the reason.
std::string thickness_of(const BeamGraph& graph, const RunOptions& run) {
  double thickest = 0;
  for (const BeamGraph::Strut& s : graph.struts) thickest = std::max({thickest, s.radius[0], s.radius[1]});
  const auto runs_free = [&](double factor) {
    BeamGraph thinner = graph;
    for (BeamGraph::Node& node : thinner.nodes) node.radius *= factor;
    for (BeamGraph::Strut& s : thinner.struts)
      for (double& radius : s.radius) radius *= factor;
    return struts_run_free(thinner, run);
  };
  double least = 0.1, most = 1;
  if (!runs_free(least)) return {};
  while (most - least > 0.02) {
    const double middle = (least + most) / 2;
    (runs_free(middle) ? least : most) = middle;
  }
  const auto rounded = [](double x) { return format_number(std::floor(x * 1e2) / 1e2); };
  return "radius " + rounded(thickest) + " mm, where struts of these nodes run free between them up to about " +
         rounded(least * thickest) + " mm";
}

/// Which cells the body's boundary passes through, and which are inside of it.
struct Places {
  std::uint64_t all = 0, inside = 0, crossing = 0;
};

/// Where beams come near the boundary, it passes through them if it cuts an axis, if a point of its edges is in a beam,
/// or if points of beams are on both sides.
class BeamPlaces {
 public:
  explicit BeamPlaces(const Solids& body) {
    constexpr std::size_t points_an_edge = 15;
    for (const TopoDS_Shape& solid : body) {
      solids_.emplace_back(solid);
      lines_.emplace_back().Load(solid, Precision::Confusion());
      for (TopExp_Explorer it(solid, TopAbs_FACE); it.More(); it.Next())
        surfaces_.emplace_back(TopoDS::Face(it.Current()));
      const std::vector<Vec3> along = points_along_edges(solid, points_an_edge);
      edges_.insert(edges_.end(), along.begin(), along.end());
      for (TopExp_Explorer it(solid, TopAbs_VERTEX); it.More(); it.Next())
        edges_.push_back(to_vec(BRep_Tool::Pnt(TopoDS::Vertex(it.Current()))));
    }
  }

  void add(const eval::BeamsShape& beams, const Affine& map) {
    Box3 box;
    const double scale = std::cbrt(std::fabs(determinant(map.linear)));
    for (const eval::StrutNode& node : beams.nodes) extend(box, map * node.position, scale * node.ball_radius);
    for (const eval::Strut& s : beams.struts) {
      extend(box, map * beams.nodes[s.from].position, scale * s.radius_from);
      extend(box, map * beams.nodes[s.to].position, scale * s.radius_to);
    }
    bool is_in = false, is_out = false;
    const auto look_at = [&](Vec3 p) { (is_inside(p) ? is_in : is_out) = true; };
    const Vec3 centre = (box.min + box.max) / 2;
    if (!is_near(box, centre)) {
      look_at(map * beams.nodes.front().position);
    } else if (passes_through(beams, map, scale, box)) {
      is_in = is_out = true;
    } else {
      const auto around = [&](Vec3 p, double radius) {
        for (std::size_t a = 0; a < 3 && !(is_in && is_out); ++a)
          for (const double r : {-radius, radius}) {
            Vec3 q = p;
            q[a] += r;
            look_at(q);
          }
      };
      for (const eval::StrutNode& node : beams.nodes) around(map * node.position, scale * node.ball_radius);
      for (const eval::Strut& s : beams.struts)
        for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0})
          around(map * ((1 - t) * beams.nodes[s.from].position + t * beams.nodes[s.to].position),
                 0.7 * scale * ((1 - t) * s.radius_from + t * s.radius_to));
    }
    ++places_.all;
    places_.crossing += is_in && is_out;
    places_.inside += is_in && !is_out;
  }
  [[nodiscard]] const Places& places() const { return places_; }

 private:
  static void extend(Box3& box, Vec3 p, double radius) {
    box.extend(p - Vec3{radius, radius, radius});
    box.extend(p + Vec3{radius, radius, radius});
  }
  [[nodiscard]] bool is_near(const Box3& box, Vec3 centre) const {
    const double radius = norm(box.max - centre);
    return std::ranges::any_of(surfaces_, [&](const CarrierSurface& surface) {
      return surface.box().intersects(box) && std::fabs(surface.signed_distance(centre)) <= radius;
    });
  }
  [[nodiscard]] bool passes_through(const eval::BeamsShape& beams, const Affine& map, double scale, const Box3& box) {
    std::vector<Vec3> near;
    for (const Vec3 p : edges_)
      if (box.intersects({p, p})) near.push_back(p);
    for (const eval::StrutNode& node : beams.nodes)
      for (const Vec3 p : near)
        if (norm(p - map * node.position) < scale * node.ball_radius) return true;
    for (const eval::Strut& s : beams.struts) {
      const Vec3 from = map * beams.nodes[s.from].position, to = map * beams.nodes[s.to].position;
      const double length = norm(to - from);
      const Vec3 axis = (to - from) / length;
      for (const Vec3 p : near) {
        const double along = dot(p - from, axis), t = along / length;
        if (t > 0 && t < 1 && norm(p - from - along * axis) < scale * ((1 - t) * s.radius_from + t * s.radius_to))
          return true;
      }
      for (IntCurvesFace_ShapeIntersector& lines : lines_) {
        lines.Perform(gp_Lin(to_pnt(from), gp_Dir(axis.x, axis.y, axis.z)), 0, length);
        if (lines.IsDone() && lines.NbPnt() > 0) return true;
      }
    }
    return false;
  }
  [[nodiscard]] bool is_inside(Vec3 p) {
    return std::ranges::any_of(solids_,
                               [&](PointInSolid& s) { return s.state(p, Precision::Confusion()) == TopAbs_IN; });
  }

  std::deque<PointInSolid> solids_;  // they cannot be moved
  std::deque<IntCurvesFace_ShapeIntersector> lines_;
  std::vector<Vec3> edges_;  ///< points of the body's edges, and its vertices
  std::vector<CarrierSurface> surfaces_;
  Places places_;
};

std::optional<Places> places_of(const Solids& body, const eval::CellStream& cells, const SolidContext& context) {
  const eval::BeamsShape* of_part = context.parts != nullptr ? context.parts->beams_in(cells) : nullptr;
  BeamPlaces places(body);
  const auto take = [&](const eval::PlacedCell& cell) {
    const auto shape = of_part == nullptr ? cells.shape(cell, context.sink) : std::nullopt;
    const auto* beams = shape ? std::get_if<eval::BeamsShape>(&shape->value) : of_part;
    if (beams == nullptr || context.run.should_stop()) return false;
    places.add(*beams, cell.mapping == CellMapping::conformal ? Affine{} : cell.world_from_cell);
    return true;
  };
  if (!cells.visit(0, cells.size(), take, context.sink)) return {};
  return places.places();
}

struct GraphSolids {
  Solids solids;
  std::string why_not;
  std::optional<FusedLimit> may_be_fused{};
  bool may_be_joined = false;
};

GraphSolids too_large(std::uint64_t faces, const eval::CellStream& cells, const FoldContext& context) {
  std::string why = "a boolean of " + std::to_string(faces) + " faces or more takes too long, " +
                    std::to_string(most_graph_faces) + " are the most";
  if (would_gain_from_balls(cells, context.solid))
    why += "; nodeRadius=\"auto\" takes none in a lattice of boxes side by side";
  return {{}, std::move(why)};
}

/// Before the minutes that it may now take.
void tell_of_minutes(std::size_t faces, const FoldContext& context) {
  constexpr std::size_t quickly = 2'000;
  if (faces <= quickly) return;
  const double minutes = std::ceil(seconds_a_graph_face * static_cast<double>(faces) / 60);
  context.solid.report(Code::geometry_long_boolean, context.where(), {std::to_string(faces), format_number(minutes)});
  context.solid.run.report("realise", context.done);
}

GraphSolids graph_solids(const eval::CellStream& cells, const FoldContext& context) {
  const SolidContext& solid = context.solid;
  constexpr std::uint64_t most_cells = 100'000;  // to be looked at: a second
  if (cells.size() > most_cells) return too_large(cells.size(), cells, context);
  SnappedRadii snapped;
  std::string why;
  const auto graph = beam_graph(cells, snapped, why, solid);
  if (!graph) return {{}, why, FusedLimit{}, true};
  if (graph->struts.size() > most_graph_faces) return too_large(graph->struts.size(), cells, context);
  DiagnosticSink apart;
  const SolidContext own{solid.source, solid.run, apart, solid.parts};
  const auto made = beam_graph_part(cells, context.where(), {.run = solid.run}, own);
  for (const Diagnostic& d : apart.diagnostics())
    if (d.code == Code::geometry_struts_meet)
      why = d.args.front();
    else if (made)
      solid.sink.report(d);
  if (!made && cells.size() <= few_cells) return {{}, why, FusedLimit{}, true};
  if (!made) {
    if (const std::string thick = thickness_of(*graph, solid.run); !thick.empty())
      solid.report(Code::geometry_struts_thick, context.where(), {thick});
    return {{}, why};
  }
  if (const std::size_t faces = measure(made->body).faces; faces > most_graph_faces)
    return too_large(faces, cells, context);
  // Cells that keep apart are placed, not joined.
  if (cells.size() > 1 && 2 * made->body.solids.size() > cells.size())
    return {{}, "the cells keep apart", FusedLimit{}, true};
  tell_of_minutes(measure(made->body).faces, context);
  auto solids = solids_from(made->body, Edges::as_they_are);
  if (!solids) return {{}, "OpenCASCADE's faces do not enclose what the beams hold", FusedLimit{}, true};
  return {std::move(*solids), {}};
}

}  // namespace

bool may_be_graph_step(const Solids& body, const eval::CellStream& cells, const FoldContext& context) {
  return !body.empty() && context.apply.boundary.value_or(BoundaryRule::clip) == BoundaryRule::clip &&
         cells.size() <= context.solid.run.max_cells && may_be_beam_graph(cells, context.solid);
}

GraphStep apply_graph(const Solids& body, const eval::CellStream& cells, const FoldContext& context,
                      CellCounts& counts) {
  GraphSolids graph = graph_solids(cells, context);
  if (graph.solids.empty()) return {{}, std::move(graph.why_not), graph.may_be_fused, graph.may_be_joined};
  DiagnosticSink apart;
  const SolidContext own{context.solid.source, context.solid.run, apart, context.solid.parts};
  auto step = apply_solids(body, graph.solids, {own, context.apply, 0, context.max_boolean_solids});
  if (!step) {
    if (context.solid.run.should_stop()) {
      for (const Diagnostic& d : apart.diagnostics()) context.solid.sink.report(d);
      return {};
    }
    const std::string fault = apart.diagnostics().empty() ? "" : ": " + message(apart.diagnostics().front());
    return {{}, "a boolean fails" + fault, few_fused};
  }
  for (const Diagnostic& d : apart.diagnostics()) context.solid.sink.report(d);
  const auto places = places_of(body, cells, context.solid);
  if (!places) return {};
  const bool is_union = context.apply.operation == ApplyOperation::union_;
  counts.placed += cells.size();
  counts.kept += is_union ? places->all : places->inside + places->crossing;
  counts.crossing += places->crossing;
  step->reaches = places->inside + places->crossing > 0;
  return {std::move(step)};
}

}  // namespace meso::brep
