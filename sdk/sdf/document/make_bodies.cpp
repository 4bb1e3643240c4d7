// SPDX-License-Identifier: Apache-2.0
#include "document_maker.hpp"
#include "leaf_formulas.hpp"

namespace meso::sdf {

bool DocumentMaker::is_csg(Index node) const {
  for (;; node = below(node)) {
    const Instruction& at = word(node);
    const bool is_primitive =
        at.verb == Verb::ball || at.verb == Verb::box || at.verb == Verb::cone || at.verb == Verb::torus;
    if (is_primitive) return true;
    const bool is_placed = at.verb == Verb::move || at.verb == Verb::rotate ||
                           (at.verb == Verb::scale && has_positive_factors(at)) || at.verb == Verb::mirror;
    if (!is_placed) return false;
  }
}

std::optional<CsgNode> DocumentMaker::csg(Index node) {
  const Instruction& at = word(node);
  const auto& n = at.numbers;
  const std::string id = name(node);
  const auto operands = [&](auto made) -> std::optional<CsgNode> {
    auto inner = csg(below(node));
    if (!inner) return std::nullopt;
    made.operands.push_back(std::move(*inner));
    return CsgNode{std::move(made)};
  };
  switch (at.verb) {
    case Verb::ball:
      return CsgNode{SpherePrimitive{.radius = {"1"}}};
    case Verb::box: {
      BoxPrimitive box{.x = Expression{"-1"}, .y = Expression{"-1"}, .z = Expression{"-1"}};
      box.dx = box.dy = box.dz = Expression{"2"};
      return CsgNode{box};
    }
    case Verb::cone: {
      const Expression zero{"0"}, height = number(id + "Height", n[2]);
      if (n[0] == n[1])
        return CsgNode{CylinderPrimitive{.x1 = zero,
                                         .y1 = zero,
                                         .z1 = zero,
                                         .x2 = zero,
                                         .y2 = zero,
                                         .z2 = height,
                                         .radius = number(id + "Radius", n[0])}};
      return CsgNode{ConePrimitive{.x1 = zero,
                                   .y1 = zero,
                                   .z1 = zero,
                                   .x2 = zero,
                                   .y2 = zero,
                                   .z2 = height,
                                   .radius1 = number(id + "Bottom", n[0]),
                                   .radius2 = number(id + "Top", n[1])}};
    }
    case Verb::torus:
      return CsgNode{
          TorusPrimitive{.major_radius = number(id + "Ring", n[0]), .minor_radius = number(id + "Tube", n[1])}};
    case Verb::move:
      return operands(
          CsgTranslate{.x = number(id + "X", n[0]), .y = number(id + "Y", n[1]), .z = number(id + "Z", n[2])});
    case Verb::rotate:
      return operands(CsgRotate{.x = number(id + "X", n[0]),
                                .y = number(id + "Y", n[1]),
                                .z = number(id + "Z", n[2]),
                                .angle = number(id + "Angle", n[3])});
    case Verb::mirror:
      number(id + "X", n[0]), number(id + "Y", n[1]), number(id + "Z", n[2]);
      return operands(CsgTransform{.matrix = {mirror_matrix(id)}, .mirror = true});
    default:
      break;
  }
  if (n[0] == n[1] && n[1] == n[2]) return operands(CsgScale{.factor = number(id + "Factor", n[0])});
  return operands(CsgScale{.x = number(id + "X", n[0]), .y = number(id + "Y", n[1]), .z = number(id + "Z", n[2])});
}

std::optional<Operand> DocumentMaker::macrostructure(Index node) {
  auto body = csg(node);
  if (!body) return std::nullopt;
  Macrostructure made{.id = {name(node) + "Body"}, .body = CsgBody{.operands = {std::move(*body)}}};
  const std::string id = made.id.text;
  document_.macrostructures.items.push_back(std::move(made));
  return Operand{Operand::Kind::macrostructure, id};
}

std::optional<Operand> DocumentMaker::file(Index node) {
  std::error_code error;
  const auto path = std::filesystem::absolute(word(node).text, error);
  const auto from = std::filesystem::absolute(folder_.empty() ? "." : folder_, error).lexically_normal();
  const auto href = path.lexically_normal().lexically_relative(from);
  if (href.empty() || *href.begin() == "..") return fault(node, "the mesh does not lie in the document's folder");
  Macrostructure made{.id = {name(node) + "Body"},
                      .body = ImportBody{.href = {href.generic_string()}, .unit = LengthUnit::millimeter}};
  const std::string id = made.id.text;
  document_.macrostructures.items.push_back(std::move(made));
  return Operand{Operand::Kind::macrostructure, id};
}

}  // namespace meso::sdf
