// SPDX-License-Identifier: Apache-2.0
#include "realise_beam_graph.hpp"

#include <algorithm>
#include <cmath>

#include "beam_graph_body.hpp"
#include "meso/base/number.hpp"
#include "meso/brep/measure.hpp"
#include "solid_primitive.hpp"

namespace meso::brep {
namespace {

const BeamsBody* beams_of(const eval::CellStream& cells) { return std::get_if<BeamsBody>(&cells.unit_cell().body); }

struct SwallowedBeam {
  double ball = 0, length = 0;
};

/// A beam that ends within the ball of its other node: struts leave that node so close together that they do not part
/// on the way.
std::optional<SwallowedBeam> swallowed_beam(const BeamGraph& graph) {
  for (const BeamGraph::Strut& strut : graph.struts) {
    const auto& [first, second] = strut.node;
    const double length = norm(graph.nodes[second].position - graph.nodes[first].position);
    const double ball = std::max(graph.nodes[first].radius, graph.nodes[second].radius);
    if (ball > length && ball > 2 * std::max(strut.radius[0], strut.radius[1])) return SwallowedBeam{ball, length};
  }
  return {};
}

}  // namespace

bool may_be_beam_graph(const eval::CellStream& cells) {
  return beams_of(cells) != nullptr && !cells.unit_cell().clip_to_box.value_or(false);
}

bool has_touching_circles(const eval::CellStream& cells) {
  const BeamsBody* beams = beams_of(cells);
  return beams != nullptr && beams->node_radius && beams->node_radius->text == "auto";
}

std::optional<BeamGraphPart> beam_graph_part(const eval::CellStream& cells, ElementId where,
                                             const LatticeOptions& options, const SolidContext& context) {
  SnappedRadii snapped;
  std::string why;
  auto graph = beam_graph(cells, snapped, why, context);
  const std::uint64_t kept = graph ? graph->cells : 0;
  const auto swallowed = graph && has_touching_circles(cells) ? swallowed_beam(*graph) : std::nullopt;
  const auto joints = graph ? joints_of(std::move(*graph), snapped, why) : std::nullopt;
  if (!joints) {
    if (!why.empty()) context.report(Code::geometry_struts_meet, where, {why});
    // Booleans of such balls take minutes and fail.
    if (swallowed)
      context.report(Code::geometry_struts_thick, where,
                     {format_number(swallowed->ball), format_number(swallowed->length)});
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
  if (snapped.count > 0)
    context.report(Code::geometry_radii_snapped, where, {std::to_string(snapped.count), format_number(snapped.most)});
  return BeamGraphPart{std::move(*body), kept};
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
