// SPDX-License-Identifier: Apache-2.0
#include "generators.hpp"

#include <algorithm>
#include <set>

#include "meso/model/walk.hpp"

namespace meso {
namespace {

class GeneratorCheck {
 public:
  GeneratorCheck(Context& c, const Pattern& pattern, const std::vector<Axis>* axes, Scope& names)
      : c_(c), pattern_(pattern), axes_(axes), names_(names), outer_names_(&c.parameters) {}

  void operator()(const Loop& loop);
  void operator()(const Scatter& scatter);
  void operator()(const PlacementList& list);
  void operator()(const Fill& fill);

 private:
  void index(const Element& element, const Name& name) {
    if (c_.check_name(element, "index", name.text))
      c_.declare(names_, element, "index", name.text, "an index of the pattern '" + pattern_.id.text + "'");
  }
  void index(const Element& element, const std::optional<Name>& name) {
    if (name) index(element, *name);
  }
  /// The axis, if it is one of the system and not used before.
  const Axis* axis(const Element& element, const Name& name) {
    if (axes_ == nullptr) return nullptr;
    const std::string_view system = pattern_.coordinate_system ? pattern_.coordinate_system->text : std::string_view();
    const auto position = find_axis(c_, *axes_, system, element, "axis", name);
    if (!position) return nullptr;
    if (!used_.insert(*position).second) c_.report(Code::axis_twice, element, "axis", {name.text});
    return &(*axes_)[*position];
  }
  ///
  void check_system(const Scatter& scatter, const VectorField& field) {
    if (!field.structure || !pattern_.coordinate_system) return;
    const auto system = std::visit(
        [](const auto& location) -> std::string {
          if constexpr (requires { location.coordinate_system; })
            return location.coordinate_system ? location.coordinate_system->text : std::string();
          return {};
        },
        field.structure->location);
    if (system != pattern_.coordinate_system->text)
      c_.report(Code::scatter_system, scatter, "field",
                {field.id.text, system.empty() ? "none" : "'" + system + "'", pattern_.coordinate_system->text});
  }
  ///
  void distance(const Element& element, std::string_view attribute, const Axis& axis, std::optional<double> value) {
    if (axis.kind == AxisKind::distance && value && *value < 0)
      c_.report(Code::distance_negative, element, attribute, {axis.name.text, format_number(*value)});
  }
  void expressions(const Loop& loop);

  Context& c_;
  const Pattern& pattern_;
  const std::vector<Axis>* axes_;
  Scope& names_;
  Scope outer_names_;  ///< what a loop sees: parameters, indices and axes of the loops around it
  std::set<std::size_t> used_;
};

void GeneratorCheck::expressions(const Loop& loop) {
  if (c_.check(loop, "count", loop.count, outer_names_))
    require_whole(c_, loop, "count", ExpressionList{loop.count.text}, 0);
  (void)c_.check(loop, "x", loop.x, outer_names_);
  (void)c_.check(loop, "y", loop.y, outer_names_);
  (void)c_.check(loop, "z", loop.z, outer_names_);
  (void)c_.check(loop, "start", loop.start, outer_names_);
  outer_names_.add(loop.index.text, "an index");
  (void)c_.check(loop, "spacing", loop.spacing, outer_names_);
  (void)c_.check(loop, "position", loop.position, outer_names_);
  if (loop.size) {
    // Of its coordinate alone: it holds between the cells' corners, too.
    Scope names(&c_.parameters);
    if (loop.axis) names.add(loop.axis->text, "an axis");
    if (c_.check(loop, "size", *loop.size, names)) c_.require_positive(loop, "size", loop.size);
  }
  if (loop.axis) outer_names_.add(loop.axis->text, "an axis");
}

void GeneratorCheck::operator()(const Loop& loop) {
  index(loop, loop.index);
  expressions(loop);
  const bool has_direction = loop.x || loop.y || loop.z;
  if (loop.axis && has_direction)
    c_.report(Code::attribute_ineffective, loop, "axis", {"axis", "beside a direction x y z"});
  if (has_direction && c_.is_zero(loop.x, loop.y, loop.z)) c_.report(Code::direction_zero, loop, "", {});
  if (!loop.axis && !has_direction) {
    const std::string_view lost = loop.spacing    ? "spacing"
                                  : loop.position ? "position"
                                  : loop.size     ? "size"
                                  : loop.start    ? "start"
                                                  : "";
    if (!lost.empty())
      c_.report(Code::attribute_ineffective, loop, lost, {std::string(lost), "without axis or direction"});
    return;
  }
  const int given = (loop.spacing ? 1 : 0) + (loop.position ? 1 : 0) + (loop.size ? 1 : 0);
  if (given != 1)
    c_.report(Code::choice_needed, loop, "",
              {"spacing, position and size", given == 0   ? "none"
                                             : given == 2 ? "two"
                                                          : "all"});
  else if (loop.size && !loop.axis)
    c_.report(Code::attribute_ineffective, loop, "size", {"size", "along a direction: it is a function of an axis"});
  else if (loop.start && loop.position)
    c_.report(Code::attribute_ineffective, loop, "start", {"start", "beside position"});
  if (!loop.axis) return;
  const Axis* found = axis(loop, *loop.axis);
  if (found != nullptr && loop.start) distance(loop, "start", *found, c_.constant(*loop.start));
}

void GeneratorCheck::operator()(const Scatter& scatter) {
  index(scatter, scatter.index);
  Scope record(&c_.parameters);
  if (const VectorField* field = c_.find(scatter.field)) {
    for (const std::string& component : component_names(*field)) {
      record.add(field->id.text + "." + component, "a component");
      names_.add(field->id.text + "." + component, "a component");
    }
    if (!field->structure) c_.report(Code::field_without_records, scatter, "field", {field->id.text});
    check_system(scatter, *field);
  } else {
    record.open();
    names_.open();
  }
  if (scatter.sort) (void)c_.check(*scatter.sort, "by", scatter.sort->by, record);
  if (scatter.thin && c_.check(*scatter.thin, "distance", scatter.thin->distance, c_.parameters))
    c_.require_not_negative(*scatter.thin, "distance", scatter.thin->distance);
}

void GeneratorCheck::operator()(const PlacementList& list) {
  index(list, list.index);
  for (const ListPlace& place : list.places) {
    if (!c_.check(place, "at", place.at, c_.parameters) || axes_ == nullptr) continue;
    const std::size_t count = split_count(place.at);
    if (count > axes_->size())
      c_.report(Code::expression_list_count, place, "at",
                {"1 to " + std::to_string(axes_->size()), std::to_string(count)});
    const auto values = c_.constants(place.at);
    for (std::size_t i = 0; values && i < std::min(count, axes_->size()); ++i)
      distance(place, "at", (*axes_)[i], (*values)[i]);
  }
}

void GeneratorCheck::operator()(const Fill& fill) {
  if (fill.ranges.empty()) c_.report(Code::content_needed, fill, "", {"fill", "at least one <range>", "none"});
  for (const FillRange& range : fill.ranges) {
    index(range, range.index);
    walk(range, ExpressionCheck{c_, c_.parameters});
    c_.require_positive(range, "step", range.step);
    const Axis* found = axis(range, range.axis);
    if (found == nullptr) continue;
    distance(range, "from", *found, c_.constant(range.from));
  }
}

}  // namespace

void check_generator(Context& c, const Pattern& pattern, const std::vector<Axis>* axes, Scope& names) {
  const int found =
      (pattern.loops.empty() ? 0 : 1) + (pattern.scatter ? 1 : 0) + (pattern.list ? 1 : 0) + (pattern.fill ? 1 : 0);
  if (found != 1) c.report(Code::generator_count, pattern, "", {found == 0 ? "none" : std::to_string(found)});
  GeneratorCheck check(c, pattern, axes, names);
  for (const Loop& loop : pattern.loops) check(loop);
  if (pattern.scatter) check(*pattern.scatter);
  if (pattern.list) check(*pattern.list);
  if (pattern.fill) check(*pattern.fill);
}

void check_conformal_generator(Context& c, const Pattern& pattern, const std::vector<Axis>& axes) {
  if (pattern.scatter || pattern.list) {
    c.report(Code::conformal_generator, pattern, "mapping",
             {pattern.scatter ? "<scatter> has none" : "<list> has none"});
    return;
  }
  std::set<std::string_view> stepped;
  for (const Loop& loop : pattern.loops) {
    if (loop.x || loop.y || loop.z)
      c.report(Code::conformal_generator, loop, "", {"this loop runs along a direction"});
    else if (loop.axis)
      stepped.insert(loop.axis->text);
    c.require_positive(loop, "spacing", loop.spacing);
  }
  if (pattern.fill)
    for (const FillRange& range : pattern.fill->ranges) stepped.insert(range.axis.text);
  for (std::size_t i = 0; i < 3; ++i) {
    if (i >= axes.size())
      c.report(Code::conformal_generator, pattern, "mapping", {"the system has only " + std::to_string(axes.size())});
    else if (axes[i].kind == AxisKind::scalar)
      c.report(Code::scalar_axis, pattern, "mapping", {axes[i].name.text});
    else if (!stepped.contains(axes[i].name.text))
      c.report(Code::conformal_generator, pattern, "mapping", {"nothing steps along '" + axes[i].name.text + "'"});
    if (i >= axes.size()) return;
  }
}

}  // namespace meso
