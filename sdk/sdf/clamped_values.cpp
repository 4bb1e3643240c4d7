// SPDX-License-Identifier: Apache-2.0
#include "meso/sdf/clamped_values.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "arguments.hpp"
#include "meso/base/number.hpp"
#include "meso/implicit/flat_term.hpp"
#include "meso/implicit/grid.hpp"
#include "meso/sdf/solid_tree.hpp"
#include "place_of_solid.hpp"

namespace meso::sdf {
namespace {

using implicit::Term;
using Place = std::array<Term, 3>;

constexpr std::int32_t along = 33;
constexpr double slack = 1e-9;  // rounding is nobody's fault

std::vector<Vec3> points_in(const Box3& box) {
  const implicit::Grid grid{.box = box, .nodes = {along, along, along}};
  std::vector<Vec3> points;
  for (std::int32_t k = 0; k < along; ++k)
    for (std::int32_t j = 0; j < along; ++j)
      for (std::int32_t i = 0; i < along; ++i) points.push_back(grid.node(i, j, k));
  return points;
}

bool is_share(const Instruction& instruction) {
  return (instruction.verb == Verb::density || instruction.verb == Verb::blend) && !instruction.text.empty();
}

std::optional<Clamped> clamped(const Instruction& instruction, const Place& place, std::span<const Vec3> points) {
  std::vector<double> values(points.size());
  implicit::FlatTerm(term_of(instruction.text).with(place)).values(points, values);
  std::erase_if(values, [](double v) { return std::isnan(v); });
  if (values.empty()) return std::nullopt;
  const auto [least, most] = std::ranges::minmax(values);
  const auto left = std::ranges::count_if(values, [](double v) { return v < -slack || v > 1 + slack; });
  if (left == 0) return std::nullopt;
  return Clamped{&instruction, least, most, static_cast<double>(left) / static_cast<double>(points.size())};
}

}  // namespace

std::vector<Clamped> clamped_values(const Program& program, const Box3& box) {
  const SolidTree tree = solid_tree(program);
  std::vector<Clamped> result;
  if (std::ranges::none_of(tree.nodes, [](const SolidTree::Node& n) { return is_share(*n.made_by); })) return result;
  const std::vector<Vec3> points = points_in(box);
  // From the last solid down to what it is made of: each node's own point, as a function of the box's.
  std::vector<std::optional<Place>> places(tree.nodes.size());
  places.back() = Place{Term::coordinate(0), Term::coordinate(1), Term::coordinate(2)};
  for (std::size_t n = tree.nodes.size(); n-- > 0;) {
    const SolidTree::Node& node = tree.nodes[n];
    const Place& here = *places[n];
    if (is_share(*node.made_by))
      if (const auto found = clamped(*node.made_by, here, points)) result.push_back(*found);
    Place below = place_of_solid(*node.made_by);
    for (Term& coordinate : below) coordinate = coordinate.with(here);
    for (const std::uint32_t of : node.of)
      if (!places[of]) places[of] = below;
  }
  std::ranges::reverse(result);
  return result;
}

void report_clamped(std::span<const Clamped> clamped, DiagnosticSink& sink) {
  for (const Clamped& c : clamped) {
    const double percent = std::max(1.0, std::round(100 * c.part));
    Diagnostic d{
        .code = Code::sdf_clamped,
        .args = {c.made_by->text, format_number(c.least), format_number(c.most), format_number(percent) + " %"}};
    point_at(d, c.made_by->word);
    sink.report(std::move(d));
  }
}

}  // namespace meso::sdf
