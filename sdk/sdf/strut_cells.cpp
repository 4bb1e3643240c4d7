// SPDX-License-Identifier: Apache-2.0
#include "strut_cells.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <variant>

#include "meso/expr/expression.hpp"
#include "meso/library/library.hpp"

namespace meso::sdf {
namespace {

using implicit::Field;
using implicit::Term;

const BeamsBody* beams_of(std::string_view name) {
  const UnitCell* cell = find_library_cell(name);
  return cell != nullptr ? std::get_if<BeamsBody>(&cell->body) : nullptr;
}

/// A cell's parameters by name, each an expression of earlier ones.
class Values {
 public:
  void set(const std::string& name, double value) { values_[name] = value; }
  [[nodiscard]] bool knows(const std::string& name) const { return values_.contains(name); }
  [[nodiscard]] double operator()(const Expression& expression) const {
    const auto parsed = expr::parse_expression(expression.text, LengthUnit::millimeter);
    std::vector<double> values;
    for (const expr::Name& used : parsed.expression->names()) values.push_back(values_.at(used.text));
    return expr::evaluate(*parsed.expression, values).value;
  }

 private:
  std::map<std::string, double> values_;
};

struct Capsule {
  Vec3 from, to;
  double radius;
  friend bool operator==(const Capsule&, const Capsule&) = default;
};

/// A lower bound of how far it is from the box.
double distance(const Capsule& c, const Box3& box) {
  double square = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double lo = std::min(c.from[a], c.to[a]), hi = std::max(c.from[a], c.to[a]);
    const double gap = std::max({0.0, lo - box.max[a], box.min[a] - hi});
    square += gap * gap;
  }
  return std::sqrt(square) - c.radius;
}

std::vector<Capsule> capsules_of(const BeamsBody& body, const Values& value) {
  std::map<std::string, Vec3> at;
  std::vector<Capsule> result;
  for (const BeamNode& node : body.nodes) {
    const Vec3 p{value(node.x), value(node.y), value(node.z)};
    at[node.name.text] = p;
    if (const auto& radius = node.radius ? node.radius : body.node_radius) result.push_back({p, p, value(*radius)});
  }
  for (const Beam& beam : body.beams)
    result.push_back({at.at(beam.from.text), at.at(beam.to.text), value(beam.radius ? *beam.radius : *body.radius)});
  return result;
}

/// With those of the cells around that come near.
std::vector<Capsule> with_neighbours(const std::vector<Capsule>& own, Vec3 period) {
  constexpr double near = 0.125;
  const Box3 box{{}, period};
  std::vector<Capsule> result;
  for (int k = -1; k <= 1; ++k)
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) {
        const Vec3 shift{i * period.x, j * period.y, k * period.z};
        for (const Capsule& c : own) {
          const Capsule there{c.from + shift, c.to + shift, c.radius};
          if (distance(there, box) <= near && std::ranges::find(result, there) == result.end()) result.push_back(there);
        }
      }
  return result;
}

}  // namespace

bool is_strut_cell(std::string_view name) { return beams_of(name) != nullptr; }

std::vector<std::string> strut_words() {
  std::vector<std::string> words;
  for (const std::string_view name : library_cell_names())
    if (is_strut_cell(name)) words.push_back("strut." + std::string(name));
  return words;
}

StrutLattice strut_lattice(std::string_view name, double radius) {
  const UnitCell& cell = *find_library_cell(name);
  Values value;
  value.set("cellEdge", 1);
  value.set("strutRadius", radius);
  for (const CellParameter& parameter : cell.parameters)
    if (!value.knows(parameter.name.text)) value.set(parameter.name.text, value(parameter.value));
  const Vec3 period{value(cell.box->dx), value(cell.box->dy), value(cell.box->dz)};
  Term all;
  bool first = true;
  for (const Capsule& c : with_neighbours(capsules_of(*beams_of(name), value), period)) {
    const Term one = Field::capsule(c.from, c.to, c.radius).term();
    all = first ? one : min(all, one);
    first = false;
  }
  std::array<Term, 3> folded;
  for (std::size_t a = 0; a < 3; ++a) {
    const Term x = Term::coordinate(a);
    folded[a] = x - period[a] * Term::apply(expr::Op::floor, {(1 / period[a]) * x});
  }
  return {all.with(folded), period};
}

}  // namespace meso::sdf
