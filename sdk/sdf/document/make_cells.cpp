// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "document_maker.hpp"
#include "leaf_formulas.hpp"
#include "meso/expr/expression.hpp"
#include "meso/implicit/surfaces.hpp"

namespace meso::sdf {

std::optional<Operand> DocumentMaker::strut(Index node, const Box3& region, const Instruction* scale) {
  const std::string id = name(node);
  double edge = 1;
  if (scale != nullptr) {
    edge = scale->numbers[0];
    if (scale->numbers[1] != edge || scale->numbers[2] != edge)
      return fault(*scale, "cells of struts have one edge; scale by one number");
  }
  const Expression cell_edge = number(id + "Edge", edge), radius = number(id + "Radius", word(node).numbers[0]);
  UnitCell cell{.id = {id}, .library = Name{word(node).text}};
  cell.parameters.push_back({.name = {"cellEdge"}, .value = cell_edge});
  cell.parameters.push_back({.name = {"strutRadius"}, .value = {radius.text + "*" + cell_edge.text}});
  Pattern pattern;
  fill(pattern, region, {cell_edge, cell_edge, cell_edge});
  return add_pattern(std::move(cell), std::move(pattern), id);
}

// Levels may change before and after a rigid move: it is the same function. Moves are taken out as the outermost.
std::optional<DocumentMaker::Chain> DocumentMaker::chain_of(Index node) {
  Chain chain;
  for (;; node = below(node)) {
    const Instruction& at = word(node);
    if (is_level(at.verb)) {
      if (!chain.moves.empty()) return std::nullopt;
      chain.levels.insert(chain.levels.begin(), &at);
      chain.levels_nodes.insert(chain.levels_nodes.begin(), node);
      continue;
    }
    if (at.verb == Verb::scale && has_positive_factors(at) && tree_.nodes[below(node)].of.empty()) {
      chain.scale = &at;
      continue;
    }
    if (!tree_.nodes[node].of.empty() && at.verb != Verb::blend) return std::nullopt;
    chain.leaf = node;
    return chain;
  }
}

// A cell's own x, y, z begin in each cell anew.
Expression DocumentMaker::set_at_points(UnitCell& cell, Pattern& pattern, const std::string& id,
                                        const std::string& text) {
  cell.parameters.push_back({.name = {id}, .value = {"0"}});
  const std::string value = renamed(text, [](const std::string& used) {
    const bool is_axis = used == "x" || used == "y" || used == "z";
    return is_axis ? std::optional("global." + used) : std::nullopt;
  });
  pattern.instructions.push_back(SetInstruction{.parameter = {id}, .value = {value}, .at = SetAt::point});
  return {id};
}

bool DocumentMaker::set_levels(const Chain& chain, UnitCell& cell, ImplicitBody& body, Pattern& pattern,
                               bool is_periodic) {
  std::string factor;  // of levels that are taken of a scaled surface
  if (is_periodic && chain.scale != nullptr) factor = "/" + cell.box->dx.text;
  const auto value = [&](Index node, const std::string& suffix, double constant, const std::string& text,
                         const std::string& divided) -> Expression {
    const std::string id = name(node) + suffix;
    if (text.empty()) return {number(id, constant).text + divided};
    if (!is_periodic) return {in_document(text)};
    return {set_at_points(cell, pattern, id, in_document(text)).text + divided};
  };
  for (std::size_t i = 0; i < chain.levels.size(); ++i) {
    const Instruction& at = *chain.levels[i];
    const Index node = chain.levels_nodes[i];
    const bool is_last = i + 1 == chain.levels.size();
    const auto items = expr::split_list(at.text);
    const std::string first = at.text.empty() ? "" : std::string(items[0].text);
    if (at.verb == Verb::offset && i == 0) {
      body.isovalue = value(node, "Level", at.numbers[0], first, factor);
    } else if (at.verb == Verb::shell && is_last) {
      body.kind = ImplicitKind::shell;
      body.thickness = value(node, "Thickness", at.numbers[0], first, factor);
    } else if (at.verb == Verb::eccentric_shell && is_last && i == 0) {
      body.kind = ImplicitKind::eccentric_shell;
      body.lower = value(node, "Lower", at.numbers[0], first, factor);
      body.upper = value(node, "Upper", at.numbers[1], at.text.empty() ? "" : std::string(items[1].text), factor);
    } else if (at.verb == Verb::complement && is_last) {
      body.kind = ImplicitKind::exoskeleton;
    } else if (at.verb == Verb::density && is_last && i == 0 && is_periodic) {
      body.density = value(node, "Share", at.numbers[0], first, "");
    } else {
      fault(at, "a cell has one level and one kind; this comes on top of '" +
                    std::string(word_of(i == 0 ? word(chain.leaf).verb : chain.levels[i - 1]->verb)) + "'");
      return false;
    }
  }
  return true;
}

std::optional<std::string> DocumentMaker::field_text(Index node, UnitCell& cell) {
  const Instruction& at = word(node);
  const auto& n = at.numbers;
  if (at.verb == Verb::surface) return std::string(implicit::find_surface(at.text)->expression);
  if (at.verb == Verb::expression) return in_document(at.text);
  const auto formulas = leaf_formulas();
  const auto found = std::ranges::find(formulas, at.verb, &LeafFormula::verb);
  if (found == formulas.end()) return fault(at, "a document has no formula of its distance, which a level needs");
  for (std::size_t i = 0; i < found->parameters.size(); ++i) {
    const std::string own(found->parameters[i]);
    std::string global = name(node) + own;
    global[global.size() - own.size()] = static_cast<char>(own[0] - 32);
    cell.parameters.push_back({.name = {own}, .value = number(global, n[i])});
  }
  if (at.verb == Verb::capsule) {
    if (n[0] == n[3] && n[1] == n[4] && n[2] == n[5]) return fault(at, "it has no length; write a ball");
    for (const char axis : {'X', 'Y', 'Z'})
      cell.parameters.push_back(
          {.name = {std::string("way") + axis}, .value = {std::string("to") + axis + " - from" + axis}});
    cell.parameters.push_back({.name = {"wayWay"}, .value = {"wayX^2 + wayY^2 + wayZ^2"}});
  }
  return std::string(found->field);
}

// The first of all is the body's function; each further one comes with its weight.
bool DocumentMaker::add_blends(Index node, UnitCell& cell, ImplicitBody& body) {
  const Instruction& at = word(node);
  if (at.verb != Verb::blend) {
    if (!tree_.nodes[node].of.empty())
      return fault(node, "a blend in a document is of surfaces and expressions"), false;
    const auto field = field_text(node, cell);
    if (field) body.field = Expression{*field};
    return field.has_value();
  }
  const Index above = below(node, 1);
  if (!tree_.nodes[above].of.empty())
    return fault(above, "a blend in a document is of surfaces and expressions"), false;
  if (!add_blends(below(node), cell, body)) return false;
  const auto field = field_text(above, cell);
  if (!field) return false;
  body.blends.push_back({.field = Expression{*field}, .weight = {clamped(in_document(at.text))}});
  return true;
}

std::optional<Operand> DocumentMaker::cell(Index node, const Box3& region) {
  const auto chain = chain_of(node);
  if (!chain) return fault(node, "in a document only cells have levels, before they are moved or joined");
  const Instruction& leaf = word(chain->leaf);
  const std::string id = name(node, chain->leaf);
  UnitCell made{.id = {id}};
  ImplicitBody body;
  Pattern pattern;
  if (fills_a_share(chain->leaf)) {
    if (node != chain->leaf) return fault(node, "a blend of densities has no level on top; state another density");
    return blended_cells(node, region);
  }
  const bool is_periodic = leaf.verb == Verb::surface;
  if (leaf.verb == Verb::file || leaf.verb == Verb::strut)
    return fault(node, "in a document only surfaces, formulas and primitives have levels");
  if (is_periodic) {
    std::array<Expression, 3> edges;
    edges.fill({"1"});
    if (chain->scale != nullptr) {
      const auto& n = chain->scale->numbers;
      if (n[0] == n[1] && n[1] == n[2])
        edges.fill(number(id + "Edge", n[0]));
      else
        for (std::size_t a = 0; a < 3; ++a) edges[a] = number(id + "Edge" + "XYZ"[a], n[a]);
      if (!chain->levels.empty() && !(n[0] == n[1] && n[1] == n[2]))
        return fault(*chain->scale, "levels of a surface scaled by three factors cannot be said; scale last");
    }
    if (leaf.text == "q-star-hex") edges[1].text = "sqrt(3)*" + edges[1].text;
    made.box = CellBox{.dx = edges[0], .dy = edges[1], .dz = edges[2]};
    body.surface = leaf.text;
    fill(pattern, region, edges);
  } else {
    made.box = cell_box(with_room(region));
    place_once(pattern);
    if (!add_blends(chain->leaf, made, body)) return std::nullopt;
    if (chain->scale != nullptr) {
      const auto& n = chain->scale->numbers;
      if (n[0] != n[1] || n[1] != n[2])
        return fault(*chain->scale, "levels of a body scaled by three factors cannot be said; scale last");
      made.parameters.push_back({.name = {"scale"}, .value = number(id + "Scale", n[0])});
      body.field->text = scaled_field(body.field->text);
    }
  }
  if (!set_levels(*chain, made, body, pattern, is_periodic)) return std::nullopt;
  made.body = std::move(body);
  return add_pattern(std::move(made), std::move(pattern), name(node));
}

}  // namespace meso::sdf
