// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "document_maker.hpp"
#include "leaf_formulas.hpp"
#include "meso/expr/expression.hpp"
#include "meso/implicit/surfaces.hpp"

namespace meso::sdf {
namespace {

bool is_constant(const std::string& formula) {
  return expr::parse_expression(formula, LengthUnit::millimeter).expression->is_constant();
}

bool is_long(const Instruction& surface) { return implicit::find_surface(surface.text)->name == "q-star-hex"; }

}  // namespace

bool DocumentMaker::fills_a_share(Index node) const {
  const Verb verb = word(node).verb;
  return verb == Verb::blend ? fills_a_share(below(node)) && fills_a_share(below(node, 1)) : verb == Verb::density;
}

bool DocumentMaker::add_shares(Index node, std::vector<Share>& shares) {
  if (word(node).verb == Verb::blend) {
    if (word(below(node, 1)).verb == Verb::blend)
      return fault(node, "a blend in a document adds one surface at a time; swap the two"), false;
    if (!add_shares(below(node), shares) || !add_shares(below(node, 1), shares)) return false;
    shares.back().blend = node;
    return true;
  }
  Share share{.density = node};
  node = below(node);
  if (const Instruction& at = word(node); at.verb == Verb::scale) {
    share.scale = at.numbers[0];
    if (!has_positive_factors(at) || at.numbers[1] != share.scale || at.numbers[2] != share.scale)
      return fault(at, "surfaces in a blend of densities are scaled by one number"), false;
    node = below(node);
  }
  share.surface = &word(node);
  if (share.surface->verb != Verb::surface)
    return fault(node, "a blend of densities in a document is of surfaces, scaled or not"), false;
  if (!shares.empty() && (share.scale != shares[0].scale || is_long(*share.surface) != is_long(*shares[0].surface)))
    return fault(share.density, "densities of different periods do not blend; scale the surfaces to one"), false;
  shares.push_back(share);
  return true;
}

std::optional<Operand> DocumentMaker::blended_cells(Index node, const Box3& region) {
  std::vector<Share> shares;
  if (!add_shares(node, shares)) return std::nullopt;
  const std::string id = name(node);
  const Expression edge = shares[0].scale == 1 ? Expression{"1"} : number(id + "Edge", shares[0].scale);
  std::array<Expression, 3> edges{edge, edge, edge};
  if (is_long(*shares[0].surface)) edges[1].text = "sqrt(3)*" + edge.text;
  UnitCell cell{.id = {id}, .box = CellBox{.dx = edges[0], .dy = edges[1], .dz = edges[2]}};
  Pattern pattern;
  fill(pattern, region, edges);
  const auto share_of = [&](const Share& share) -> Expression {
    const Instruction& density = word(share.density);
    const std::string own = name(share.density) + "Share";
    return density.text.empty() ? number(own, density.numbers[0])
                                : set_at_points(cell, pattern, own, in_document(density.text));
  };
  const auto agrees = [&](const Share& share) {
    const Instruction &density = word(share.density), &first = word(shares[0].density);
    return density.text == first.text && density.numbers[0] == first.numbers[0];
  };
  const bool agree = std::ranges::all_of(shares, agrees);
  ImplicitBody body{.surface = shares[0].surface->text, .density = share_of(shares[0])};
  for (std::size_t i = 1; i < shares.size(); ++i) {
    const std::string weight = clamped(in_document(word(shares[i].blend).text));
    const std::string own = name(shares[i].blend) + "Weight";
    const Expression at_point = is_constant(weight) ? Expression{weight} : set_at_points(cell, pattern, own, weight);
    body.blends.push_back({.surface = shares[i].surface->text, .weight = at_point});
    if (!agree) body.density = Expression{blended_share(body.density->text, share_of(shares[i]).text, at_point.text)};
  }
  cell.body = std::move(body);
  return add_pattern(std::move(cell), std::move(pattern), id);
}

}  // namespace meso::sdf
