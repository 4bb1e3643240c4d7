// SPDX-License-Identifier: Apache-2.0
#include "realise_beam_graph.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "beam_graph_body.hpp"
#include "beam_graph_mitred.hpp"
#include "box_pairs.hpp"
#include "meso/base/number.hpp"
#include "meso/brep/measure.hpp"
#include "solid_primitive.hpp"

namespace meso::brep {
namespace {

/// What is told of an automatic ball that is larger than its struts ask for alone, because they leave their node close
/// together, and that passes into another: of the one that reaches farthest. Empty if there is none.
std::string crowded_node(const BeamGraph& graph) {
  const auto& nodes = graph.nodes;
  std::vector<double> thickest(nodes.size(), 0);
  for (const BeamGraph::Strut& s : graph.struts)
    for (const std::size_t end : {0u, 1u}) thickest[s.node[end]] = std::max(thickest[s.node[end]], s.radius[end]);
  std::vector<Box3> boxes(nodes.size());
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const Vec3 r{nodes[n].radius, nodes[n].radius, nodes[n].radius};
    boxes[n] = {nodes[n].position - r, nodes[n].position + r};
  }
  double farthest = 0, away = 0;
  std::size_t crowded = 0;
  visit_meeting_pairs(boxes, [&](std::size_t i, std::size_t k) {
    const double distance = norm(nodes[i].position - nodes[k].position);
    if (nodes[i].radius + nodes[k].radius <= distance) return;
    for (const std::size_t n : {i, k}) {
      const double reach = nodes[n].radius / distance;
      if (nodes[n].radius <= 2 * thickest[n] || !(reach > farthest)) continue;
      farthest = reach;
      away = distance;
      crowded = n;
    }
  });
  if (farthest == 0) return {};
  const auto rounded = [](double x) { return format_number(std::nearbyint(x * 1e3) / 1e3); };
  const auto& [position, ball] = nodes[crowded];
  // r / sin(theta / 2), the beams of neighbouring cells counted that are not there.
  const double angle = 2 * std::asin(thickest[crowded] / ball) * 180 / std::numbers::pi;
  return "the automatic ball of the node at (" + rounded(position.x) + " " + rounded(position.y) + " " +
         rounded(position.z) + "), which beams leave about " + rounded(angle) + " degrees apart, has a radius of " +
         rounded(ball) + " mm, and passes into that of a node " + rounded(away) + " mm away";
}

void tell_snapped(const SnappedRadii& snapped, ElementId where, const SolidContext& context) {
  if (snapped.count > 0)
    context.report(Code::geometry_radii_snapped, where, {std::to_string(snapped.count), format_number(snapped.most)});
}

}  // namespace

bool may_be_beam_graph(const eval::CellStream& cells, const SolidContext& context) {
  if (cells.unit_cell().clip_to_box.value_or(false)) return false;
  if (std::holds_alternative<BeamsBody>(cells.unit_cell().body)) return true;
  const eval::BeamsShape* beams = context.parts != nullptr ? context.parts->beams_in(cells) : nullptr;
  return beams != nullptr && beams->struts.size() * cells.size() <= context.run.max_cells;
}

bool has_touching_circles(const eval::CellStream& cells) {
  const auto* beams = std::get_if<BeamsBody>(&cells.unit_cell().body);
  return beams != nullptr && beams->node_radius && beams->node_radius->text == "auto";
}

bool struts_part_on_balls(const eval::CellStream& cells, const SolidContext& context) {
  constexpr std::uint64_t many = 100'000;
  if (cells.size() > many) return true;
  SnappedRadii snapped;
  std::string why;
  auto graph = beam_graph(cells, snapped, why, context);
  return graph && joints_of(std::move(*graph), snapped, why).has_value();
}

namespace {

/// `crowded`: what is told where the graph cannot be put together, if anything.
std::optional<BeamGraphPart> put_together(const std::optional<BeamGraph>& graph, SnappedRadii snapped, std::string why,
                                          const std::string& crowded, ElementId where, const LatticeOptions& options,
                                          const SolidContext& context) {
  const std::uint64_t kept = graph ? graph->cells : 0;
  const SnappedRadii of_graph = snapped;
  const auto joints = graph ? joints_of(*graph, snapped, why) : std::nullopt;
  if (graph && !joints) {
    snapped = of_graph;
    std::string why_not = "stopped";
    if (auto body = mitred_body(*graph, options, snapped, why_not)) {
      tell_snapped(snapped, where, context);
      return BeamGraphPart{std::move(*body), kept};
    }
    why += "; nor are they to be cut at each other: " + why_not;
  }
  if (!joints) {
    if (!why.empty()) context.report(Code::geometry_struts_meet, where, {why});
    // Booleans of such balls take minutes and fail.
    if (!crowded.empty()) context.report(Code::geometry_struts_thick, where, {crowded});
    return {};
  }
  auto body = beam_graph_body(*joints, options, context.sink);
  if (!body) return {};
  const double volume = measure(*body).volume;
  if (!(std::fabs(volume - body->pieces_volume) <= 1e-7 * body->pieces_volume)) {
    context.report(Code::geometry_struts_meet, where,
                   {"faces enclose " + format_number(volume) + " mm3, balls and struts hold " +
                    format_number(body->pieces_volume)});
    return {};
  }
  tell_snapped(snapped, where, context);
  return BeamGraphPart{std::move(*body), kept};
}

}  // namespace

std::optional<BeamGraphPart> beam_graph_part(const eval::CellStream& cells, ElementId where,
                                             const LatticeOptions& options, const SolidContext& context) {
  SnappedRadii snapped;
  std::string why;
  const auto graph = beam_graph(cells, snapped, why, context);
  const std::string crowded = graph && has_touching_circles(cells) ? crowded_node(*graph) : "";
  return put_together(graph, snapped, std::move(why), crowded, where, options, context);
}

std::optional<BeamGraphPart> beam_graph_part(const eval::BeamsShape& beams, ElementId where,
                                             const LatticeOptions& options, const SolidContext& context) {
  SnappedRadii snapped;
  std::string why;
  const auto graph = beam_graph(beams, where, snapped, why, context);
  return put_together(graph, snapped, std::move(why), "", where, options, context);
}

std::optional<Solids> beam_graph_primitives(const eval::CellStream& cells, const SolidContext& context) {
  SnappedRadii snapped;
  std::string why;
  const auto graph = beam_graph(cells, snapped, why, context);
  if (!graph) return {};
  Solids solids;
  for (const BeamGraph::Strut& s : graph->struts)
    solids.push_back(
        frustum(graph->nodes[s.node[0]].position, graph->nodes[s.node[1]].position, s.radius[0], s.radius[1]));
  for (const BeamGraph::Node& node : graph->nodes)
    if (node.radius > 0) solids.push_back(BRepPrimAPI_MakeSphere(to_pnt(node.position), node.radius).Solid());
  return solids;
}

}  // namespace meso::brep
