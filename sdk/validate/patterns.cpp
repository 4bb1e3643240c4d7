// SPDX-License-Identifier: Apache-2.0
// patterns, what their expressions see, and the defaults of cell parameters, which see the patterns.
#include <algorithm>
#include <set>

#include "families.hpp"
#include "generators.hpp"
#include "instructions.hpp"
#include "meso/model/walk.hpp"

namespace meso {
namespace {

/// The names that every pattern of a cell offers to the defaults of the cell's parameters.
using CommonNames = std::map<const UnitCell*, Scope>;

void keep_common(CommonNames& common, const UnitCell& cell, const Scope& pattern) {
  const auto [entry, is_first] = common.try_emplace(&cell, pattern.without_outer());
  if (!is_first) entry->second.keep_only(pattern);
}

void check_conformal(Context& c, const Pattern& pattern, const std::vector<Axis>* axes, const UnitCell* cell) {
  if (cell != nullptr && !cell->box)
    c.report(Code::box_needed, pattern, "mapping", {cell->id.text, "conformal mapping bends it"});
  for (const Instruction& instruction : pattern.instructions) check_conformal_instruction(c, instruction);
  if (axes != nullptr) check_conformal_generator(c, pattern, *axes);
}

class PatternCheck {
 public:
  PatternCheck(Context& c, std::set<std::string>& told) : c_(c), told_(told) {}

  void operator()(const Pattern& pattern, CommonNames& common) {
    const UnitCell* cell = c_.find(pattern.unit_cell);
    const std::vector<Axis>* axes = axes_of(c_, pattern.coordinate_system);
    Scope cell_names(&c_.parameters);
    if (cell != nullptr)
      for (const CellParameter& p : cell->parameters)
        cell_names.add(p.name.text, "a parameter of the unit cell '" + cell->id.text + "'");
    Scope names(&cell_names);
    if (cell == nullptr || axes == nullptr) names.open();
    if (axes != nullptr) add_axes(pattern, *axes, names);
    for (const char* name : {"global.x", "global.y", "global.z"}) names.add(name, "the cell's place");
    check_generator(c_, pattern, axes, names);
    if (cell != nullptr) keep_common(common, *cell, names);
    check_instructions(c_, pattern, cell, names);
    if (pattern.mapping == CellMapping::conformal) check_conformal(c_, pattern, axes, cell);
  }

 private:
  void add_axes(const Pattern& pattern, const std::vector<Axis>& axes, Scope& names) {
    for (const Axis& axis : axes) {
      const std::string what = "an axis of the pattern '" + pattern.id.text + "'";
      const std::string* taken = names.find(axis.name.text);
      // The same parameter against the same axis is one mistake, however many patterns show it.
      if (taken != nullptr && *taken != what && told_.insert(axis.name.text + " " + *taken).second)
        c_.report(Code::name_duplicate, pattern, "coordinateSystem", {axis.name.text, *taken, what});
      names.add(axis.name.text, what);
    }
  }

  Context& c_;
  std::set<std::string>& told_;
};

void check_defaults(Context& c, const UnitCell& cell, const Scope& common) {
  Scope names(&common);
  for (const CellParameter& p : cell.parameters) {
    const bool good = c.check(p, "value", p.value, names);
    (void)c.check(p, "min", p.min, names);
    (void)c.check(p, "max", p.max, names);
    if (good) check_bounds(c, p, "value", p.value, p.name.text, p.min, p.max);
    names.add(p.name.text, "a parameter of the cell");
  }
}

}  // namespace

void check_patterns(Context& c) {
  CommonNames common;
  std::set<std::string> told;
  for (const Pattern& pattern : c.document.patterns) PatternCheck(c, told)(pattern, common);
  for (const UnitCell& cell : c.document.unit_cells) {
    Scope names(&c.parameters);
    const auto found = common.find(&cell);
    if (found != common.end())
      names.add_all(found->second);
    else
      for (const char* name : {"global.x", "global.y", "global.z"}) names.add(name, "the cell's place");
    check_defaults(c, cell, names);
  }
}

}  // namespace meso
