// SPDX-License-Identifier: Apache-2.0
#include "arguments.hpp"

#include <algorithm>
#include <numbers>

#include "meso/expr/dimension.hpp"
#include "meso/implicit/field_arguments.hpp"

namespace meso::sdf {
namespace {

constexpr LengthUnit unit = LengthUnit::millimeter;

/// The expression, or why `text` is none; names must be among `known`.
struct Parsed {
  std::optional<expr::Expression> expression{};
  TextFault fault{};
};
Parsed parse(std::string_view text, std::initializer_list<std::string_view> known) {
  auto parsed = expr::parse_expression(text, unit);
  if (!parsed.expression) {
    const expr::ParseError& e = *parsed.error;
    return {.fault = {e.offset, e.length, message({.code = e.code, .args = e.args})}};
  }
  for (const expr::Name& name : parsed.expression->names()) {
    if (std::find(known.begin(), known.end(), name.text) != known.end()) continue;
    std::string among;
    for (const std::string_view k : known) among += (among.empty() ? "" : ", ") + std::string(k);
    return {.fault = {name.offset, name.text.size(), "there is no name '" + name.text + "' here, only pi, " + among}};
  }
  if (const auto clash = expr::dimension_of(*parsed.expression, {}).clash) {
    const auto is = [](std::string_view part, expr::Dimension dimension) {
      return "'" + std::string(part) + "' is " + std::string(to_text(dimension));
    };
    return {.fault = {clash->offset, clash->length,
                      is(clash->first, clash->first_is) + " and " + is(clash->second, clash->second_is()) +
                          ": they cannot be added, compared or chosen between"}};
  }
  return {.expression = std::move(parsed.expression)};
}

// A length may stand where a factor does: the ball of radius 1 is scaled by 5mm as well as by 5.
std::optional<std::string> misfit(const expr::Expression& expression, std::string_view text, Measure measure) {
  using expr::Dimension;
  const Dimension is = expr::dimension_of(expression, {}).dimension;
  const bool wrong = measure == Measure::length  ? is == Dimension::angle
                     : measure == Measure::angle ? is == Dimension::length
                                                 : is == Dimension::length || is == Dimension::angle;
  if (!wrong) return std::nullopt;
  const std::string_view wanted = measure == Measure::length  ? "a length or a number"
                                  : measure == Measure::angle ? "an angle"
                                                              : "a number without a unit";
  return "'" + std::string(text) + "' is " + std::string(to_text(is)) + ", wanted is " + std::string(wanted);
}

}  // namespace

NumberList read_numbers(std::string_view text, std::initializer_list<std::size_t> counts, Measure measure) {
  const auto items = expr::split_list(text);
  if (std::find(counts.begin(), counts.end(), items.size()) == counts.end()) {
    std::string wanted;
    for (const std::size_t count : counts) wanted += (wanted.empty() ? "" : " or ") + std::to_string(count);
    return {.fault = TextFault{.why = wanted + (wanted == "1" ? " number is" : " numbers are") + " expected, found " +
                                      std::to_string(items.size())}};
  }
  NumberList out;
  for (const auto& item : items) {
    Parsed parsed = parse(item.text, {"tau"});
    if (!parsed.expression) {
      parsed.fault.offset += item.offset;
      return {.fault = std::move(parsed.fault)};
    }
    if (auto why = misfit(*parsed.expression, item.text, measure))
      return {.fault = TextFault{item.offset, item.text.size(), std::move(*why)}};
    const double tau[] = {2 * std::numbers::pi};
    const auto value = expr::evaluate(*parsed.expression, tau);
    if (!value)
      return {.fault =
                  TextFault{item.offset, item.text.size(), "'" + std::string(item.text) + "' has no finite value"}};
    out.numbers.push_back(value.value);
  }
  return out;
}

std::optional<TextFault> formula_fault(std::string_view text) {
  const Parsed parsed = parse(text, {"tau", "x", "y", "z"});
  return parsed.expression ? std::nullopt : std::optional(parsed.fault);
}

bool names_point(std::string_view text) {
  const Parsed parsed = parse(text, {"tau", "x", "y", "z"});
  return parsed.expression && std::ranges::any_of(parsed.expression->names(), [](const expr::Name& name) {
           return name.text.size() == 1;  // tau is the one other
         });
}

std::optional<TextFault> formulas_fault(std::string_view text, std::size_t count, Measure measure) {
  const auto items = expr::split_list(text);
  if (items.size() != count) return read_numbers(text, {count}, measure).fault;
  bool depends = false;
  for (const auto& item : items) {
    auto fault = formula_fault(item.text);
    if (fault) return fault->offset += item.offset, fault;
    depends = depends || names_point(item.text);
  }
  return depends ? std::nullopt : read_numbers(text, {count}, measure).fault;
}

implicit::Term term_of(std::string_view formula) {
  const auto parsed = expr::parse_expression(formula, unit);
  std::vector<implicit::Term> meanings;
  for (const expr::Name& name : parsed.expression->names())
    meanings.push_back(name.text == "tau" ? implicit::Term::constant(2 * std::numbers::pi)
                                          : implicit::Term::coordinate(static_cast<std::size_t>(name.text[0] - 'x')));
  return implicit::Term::from_expression(*parsed.expression, meanings);
}

std::string fault_of(const Instruction& instruction) {
  if (instruction.verb == Verb::density && instruction.text.empty() &&
      !(instruction.numbers[0] > 0 && instruction.numbers[0] < 1))
    return "a share lies between 0 and 1";
  const auto& n = instruction.numbers;
  const Vec3 v{n[0], n[1], n[2]};
  const bool is_graded = !instruction.text.empty();
  std::optional<Diagnostic> fault;
  switch (instruction.verb) {
    case Verb::cone:
      fault = implicit::check_cone(n[0], n[1], n[2]);
      break;
    case Verb::torus:
      fault = implicit::check_torus(n[0], n[1]);
      break;
    case Verb::capsule:
      fault = implicit::check_size("radius", n[6]);
      break;
    case Verb::strut:
      if (!(n[0] < 0.25)) return "a strut's radius is less than a quarter of the cell's edge";
      fault = implicit::check_size("radius", n[0]);
      break;
    case Verb::smooth_union:
      if (n[0] < 0) return "a fillet's radius is not negative";
      break;
    case Verb::repeat:
      if (v.x < 0 || v.y < 0 || v.z < 0 || v == Vec3{}) return "steps are positive, 0 along an axis without repetition";
      break;
    case Verb::cylindrical:
    case Verb::helix:
    case Verb::spherical:
      if (n[0] == 0 || (instruction.verb == Verb::spherical && n[1] == 0)) return "it would not be bent";
      break;
    case Verb::shell:
      if (!is_graded) fault = implicit::check_shell(n[0]);
      break;
    case Verb::eccentric_shell:
      if (!is_graded) fault = implicit::check_eccentric_shell(n[0], n[1]);
      break;
    case Verb::scale:
      fault = implicit::check_scale(v);
      break;
    case Verb::rotate:
      fault = implicit::check_rotation(v, n[3]);
      break;
    case Verb::half_space:
    case Verb::mirror:
    case Verb::orient:
      fault = implicit::check_direction(instruction.word.text, v);
      break;
    default:
      break;
  }
  return fault ? message(*fault) : std::string();
}

}  // namespace meso::sdf
