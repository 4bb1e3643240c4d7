// SPDX-License-Identifier: Apache-2.0
// nodes and struts.
#include "families.hpp"
#include "meso/model/walk.hpp"

namespace meso {
namespace {

using NodeTable = std::map<std::string_view, const BeamNode*>;

NodeTable collect_nodes(Context& c, const BeamsBody& body) {
  NodeTable nodes;
  for (const BeamNode& node : body.nodes) {
    c.require_not_negative(node, "radius", node.radius);
    const auto [entry, is_new] = nodes.emplace(node.name.text, &node);
    if (is_new)
      (void)c.check_name(node, "id", node.name.text);
    else
      c.report_with_related(Code::name_duplicate, node, "id", {node.name.text, "a node", "another node"},
                            *entry->second, "id", "the other node");
  }
  return nodes;
}

const BeamNode* find_node(Context& c, const NodeTable& nodes, const Beam& beam, std::string_view attribute,
                          const Name& name) {
  const auto found = nodes.find(name.text);
  if (found != nodes.end()) return found->second;
  std::vector<std::string_view> candidates;
  if (!c.is_full())
    for (const auto& [candidate, node] : nodes) candidates.push_back(candidate);
  c.report(Code::link_unknown_node, beam, attribute, {name.text, c.suggestion(name.text, candidates)});
  return nullptr;
}

bool is_same_point(const Context& c, const BeamNode& a, const BeamNode& b) {
  const auto is_same = [&](const Expression& p, const Expression& q) {
    const auto u = c.constant(p), v = c.constant(q);
    return u && v && *u == *v;
  };
  return is_same(a.x, b.x) && is_same(a.y, b.y) && is_same(a.z, b.z);
}

void check_beam(Context& c, const BeamsBody& body, const NodeTable& nodes, const Beam& beam) {
  const BeamNode* from = find_node(c, nodes, beam, "from", beam.from);
  const BeamNode* to = find_node(c, nodes, beam, "to", beam.to);
  if (from != nullptr && from == to)
    c.report(Code::beam_same_node, beam, "to", {beam.from.text});
  else if (from != nullptr && to != nullptr && is_same_point(c, *from, *to))
    c.report(Code::body_degenerate, beam, "",
             {"its nodes '" + beam.from.text + "' and '" + beam.to.text + "' are the same point"});
  const bool has_common = beam.radius || body.radius;
  if (!has_common && !beam.radius1)
    c.report(Code::beam_without_radius, beam, "", {"'" + beam.from.text + "'"});
  else if (!has_common && !beam.radius2)
    c.report(Code::beam_without_radius, beam, "", {"'" + beam.to.text + "'"});
  c.require_positive(beam, "radius", beam.radius);
  c.require_positive(beam, "radius1", beam.radius1);
  c.require_positive(beam, "radius2", beam.radius2);
}

}  // namespace

void check_beams(Context& c, const BeamsBody& body, const Scope& scope) {
  walk(body, ExpressionCheck{c, scope});
  c.require_positive(body, "radius", body.radius);
  if (body.node_radius && body.node_radius->text != "auto")
    c.require_not_negative(body, "nodeRadius", body.node_radius);
  if (body.beams.empty()) c.report(Code::content_needed, body, "", {"beams", "at least one <beam>", "none"});
  const NodeTable nodes = collect_nodes(c, body);
  for (const Beam& beam : body.beams) check_beam(c, body, nodes, beam);
}

}  // namespace meso
