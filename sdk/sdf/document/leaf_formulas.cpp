// SPDX-License-Identifier: Apache-2.0
#include "leaf_formulas.hpp"

#include "meso/expr/expression.hpp"

namespace meso::sdf {
namespace {

constexpr std::string_view scaled_begin = "scale*(";
constexpr std::string_view clamped_begin = "clamp(", clamped_end = ", 0, 1)";

}  // namespace

std::span<const LeafFormula> leaf_formulas() {
  static const std::vector<LeafFormula> all{
      {Verb::ball, "sqrt(x^2 + y^2 + z^2) - 1"},
      {Verb::cylinder, "sqrt(x^2 + y^2) - 1"},
      {Verb::box,
       "sqrt(max(abs(x) - 1, 0)^2 + max(abs(y) - 1, 0)^2 + max(abs(z) - 1, 0)^2) + "
       "min(max(max(abs(x) - 1, abs(y) - 1), abs(z) - 1), 0)"},
      {Verb::torus, "sqrt((sqrt(x^2 + y^2) - ring)^2 + z^2) - tube", {"ring", "tube"}},
      {Verb::capsule,
       "sqrt((x - fromX - wayX*clamp(((x - fromX)*wayX + (y - fromY)*wayY + (z - fromZ)*wayZ)/wayWay, 0, 1))^2 + "
       "(y - fromY - wayY*clamp(((x - fromX)*wayX + (y - fromY)*wayY + (z - fromZ)*wayZ)/wayWay, 0, 1))^2 + "
       "(z - fromZ - wayZ*clamp(((x - fromX)*wayX + (y - fromY)*wayY + (z - fromZ)*wayZ)/wayWay, 0, 1))^2) - radius",
       {"fromX", "fromY", "fromZ", "toX", "toY", "toZ", "radius"}},
      {Verb::half_space,
       "(normalX*x + normalY*y + normalZ*z)/sqrt(normalX^2 + normalY^2 + normalZ^2) - reach",
       {"normalX", "normalY", "normalZ", "reach"}},
  };
  return all;
}

std::string in_document(std::string_view formula) {
  return renamed(formula, [](const std::string& used) {
    return used == "tau" ? std::optional<std::string>("(2*pi)") : std::nullopt;
  });
}

std::string scaled_field(std::string_view field) {
  return std::string(scaled_begin) +
         renamed(field,
                 [](const std::string& name) {
                   const bool is_axis = name == "x" || name == "y" || name == "z";
                   return is_axis ? std::optional("(" + name + "/scale)") : std::nullopt;
                 }) +
         ")";
}

std::optional<std::string> unscaled_field(std::string_view field) {
  if (!field.starts_with(scaled_begin) || !field.ends_with(')')) return std::nullopt;
  std::string text(field.substr(scaled_begin.size(), field.size() - scaled_begin.size() - 1));
  for (const char axis : {'x', 'y', 'z'}) {
    const std::string here = std::string("(") + axis + "/scale)";
    for (std::size_t at = text.find(here); at != std::string::npos; at = text.find(here, at + 1))
      text.replace(at, here.size(), 1, axis);
  }
  return scaled_field(text) == field ? std::optional(text) : std::nullopt;
}

std::string clamped(std::string_view weight) {
  return std::string(clamped_begin) + std::string(weight) + std::string(clamped_end);
}

std::string unclamped(std::string_view weight) {
  const std::size_t around = clamped_begin.size() + clamped_end.size();
  if (!weight.starts_with(clamped_begin) || !weight.ends_with(clamped_end)) return std::string(weight);
  const std::string inner(weight.substr(clamped_begin.size(), weight.size() - around));
  // clamp(a, 0, 1) + clamp(b, 0, 1) begins and ends so, too.
  return expr::parse_expression(inner, LengthUnit::millimeter).expression ? inner : std::string(weight);
}

std::string blended_share(std::string_view one, std::string_view other, std::string_view weight) {
  const std::string w(weight);
  return "(1 - " + w + ")*(" + std::string(one) + ") + " + w + "*(" + std::string(other) + ")";
}

std::optional<std::pair<std::string, std::string>> shares_of(std::string_view blended, std::string_view weight) {
  const std::string w(weight), begin = "(1 - " + w + ")*(", between = ") + " + w + "*(";
  const std::size_t middle = blended.rfind(between);
  if (!blended.starts_with(begin) || !blended.ends_with(')') || middle == std::string_view::npos ||
      middle < begin.size())
    return std::nullopt;
  const std::size_t other = middle + between.size();
  const std::pair found{std::string(blended.substr(begin.size(), middle - begin.size())),
                        std::string(blended.substr(other, blended.size() - other - 1))};
  const auto stands_alone = [](const std::string& text) {
    return expr::parse_expression(text, LengthUnit::millimeter).expression.has_value();
  };
  return stands_alone(found.first) && stands_alone(found.second) ? std::optional(found) : std::nullopt;
}

// I - 2 n n' / (n . n)
std::string mirror_matrix(const std::string& prefix) {
  const std::string square = prefix + "X^2 + " + prefix + "Y^2 + " + prefix + "Z^2";
  std::string text;
  for (const char row : {'X', 'Y', 'Z'}) {
    for (const char column : {'X', 'Y', 'Z'})
      text += std::string(row == column ? "1" : "0") + " - 2*" + prefix + row + "*" + prefix + column + "/(" + square +
              "), ";
    text += row == 'Z' ? "0" : "0, ";
  }
  return text;
}

std::string scale_matrix(const std::string& prefix) {
  return prefix + "X, 0, 0, 0, 0, " + prefix + "Y, 0, 0, 0, 0, " + prefix + "Z, 0";
}

std::string prefix_of_matrix(std::string_view matrix, std::string (*make)(const std::string&)) {
  const std::string pattern = make("?");
  const std::size_t at = pattern.find('?');
  if (matrix.substr(0, at) != pattern.substr(0, at)) return {};
  // What stands behind the prefix the first time.
  const std::string behind = pattern.substr(at + 1, pattern.find('?', at + 1) - at - 1);
  const std::size_t end = matrix.find(behind, at);
  if (end == std::string_view::npos) return {};
  std::string prefix(matrix.substr(at, end - at));
  return make(prefix) == matrix ? prefix : std::string();
}

}  // namespace meso::sdf
