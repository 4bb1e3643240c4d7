// SPDX-License-Identifier: Apache-2.0
// parts, their validation values, and what is built.
#include "families.hpp"
#include "meso/model/describe.hpp"

namespace meso {
namespace {

std::string text(ApplyOperation operation) {
  return std::string(enum_texts<ApplyOperation>[static_cast<std::size_t>(operation)]);
}
std::string text(BoundaryRule rule) { return std::string(enum_texts<BoundaryRule>[static_cast<std::size_t>(rule)]); }

///
void check_boundary(Context& c, const Apply& apply) {
  const BoundaryRule rule = apply.boundary.value_or(BoundaryRule::clip);
  if (rule == BoundaryRule::clip) {
    if (apply.test) c.report(Code::attribute_ineffective, apply, "test", {"test", "with boundary=\"clip\""});
    if (apply.clearance)
      c.report(Code::attribute_ineffective, apply, "clearance", {"clearance", "with boundary=\"clip\""});
    return;
  }
  if (apply.operation == ApplyOperation::union_)
    c.report(Code::boundary_rule, apply, "boundary", {text(rule), "with operation=\"union\""});
  else if (apply.operation == ApplyOperation::difference && rule == BoundaryRule::keep_whole)
    c.report(Code::boundary_rule, apply, "boundary", {text(rule), "with operation=\"difference\""});
  else if (apply.part)
    c.report(Code::boundary_rule, apply, "boundary", {text(rule), "for a part, which has no cells of its own"});
  const Pattern* pattern = c.find(apply.pattern);
  const UnitCell* cell = pattern != nullptr ? c.find(pattern->unit_cell) : nullptr;
  if (cell != nullptr && !cell->box && apply.test.value_or(InsideTest::box) == InsideTest::box)
    c.report(Code::box_needed, apply, "boundary", {cell->id.text, "the boundary rule tests it; or use test=\"body\""});
}

///
void check_surroundings(Context& c, const Apply& apply) {
  if (c.check(apply, "radius", apply.radius, c.parameters)) c.require_not_negative(apply, "radius", apply.radius);
  if (c.check(apply, "skin", apply.skin, c.parameters)) c.require_not_negative(apply, "skin", apply.skin);
  if (apply.skin && apply.operation == ApplyOperation::union_)
    c.report(Code::attribute_ineffective, apply, "skin", {"skin", "with operation=\"union\""});
  const BoundaryRule rule = apply.boundary.value_or(BoundaryRule::clip);
  if (rule == BoundaryRule::clip) return;
  if (apply.radius)
    c.report(Code::attribute_ineffective, apply, "radius", {"radius", "with boundary=\"" + text(rule) + "\""});
  if (apply.skin)
    c.report(Code::attribute_ineffective, apply, "skin", {"skin", "with boundary=\"" + text(rule) + "\""});
}

void check_apply(Context& c, const Apply& apply) {
  if (apply.pattern.has_value() == apply.part.has_value())
    c.report(Code::choice_needed, apply, "", {"pattern and part", apply.pattern ? "both" : "none"});
  if (apply.pattern && !apply.part && apply.placement)
    c.report(Code::attribute_ineffective, *apply.placement, "",
             {"a placement", "on a pattern: the pattern's coordinateSystem places it"});
  else
    check_placement(c, apply.placement, c.parameters);
  if (c.check(apply, "clearance", apply.clearance, c.parameters))
    c.require_not_negative(apply, "clearance", apply.clearance);
  check_boundary(c, apply);
  check_surroundings(c, apply);
}

///
void check_expected(Context& c, const Element& element, std::string_view attribute, std::optional<double> value) {
  if (value && *value < 0)
    c.report(Code::value_negative, element, attribute, {std::string(attribute), format_number(*value)});
}

void check_validation(Context& c, const Validation& validation) {
  for (const auto* expected : {&validation.volume, &validation.area}) {
    if (!*expected) continue;
    check_expected(c, **expected, "value", (*expected)->value);
    check_expected(c, **expected, "tolerance", (*expected)->tolerance);
  }
  if (validation.centroid) check_expected(c, *validation.centroid, "tolerance", validation.centroid->tolerance);
  if (validation.count) {
    const ExpectedCount& count = *validation.count;
    check_expected(c, count, "placed", count.placed);
    check_expected(c, count, "kept", count.kept);
    check_expected(c, count, "solids", count.solids);
    check_expected(c, count, "fragments", count.fragments);
  }
}

void check_samples(Context& c, const MeshSettings& mesh) {
  if (!mesh.samples || !c.check(mesh, "samples", *mesh.samples, c.parameters)) return;
  const std::size_t count = split_count(*mesh.samples);
  if (count != 1 && count != 3)
    c.report(Code::expression_list_count, mesh, "samples", {"1 or 3", std::to_string(count)});
  else
    require_whole(c, mesh, "samples", *mesh.samples, 1);
}

///
void check_mesh(Context& c, const MeshSettings& mesh) {
  check_samples(c, mesh);
  struct Attribute {
    std::string_view name;
    const std::optional<Expression>* value;
  };
  for (const auto& [name, value] : {Attribute{"deflection", &mesh.deflection},
                                    {"angle", &mesh.angle},
                                    {"dx", &mesh.dx},
                                    {"dy", &mesh.dy},
                                    {"dz", &mesh.dz}})
    if (c.check(mesh, name, *value, c.parameters)) c.require_positive(mesh, name, *value);
  for (const auto& [name, value] : {Attribute{"x", &mesh.x}, {"y", &mesh.y}, {"z", &mesh.z}})
    (void)c.check(mesh, name, *value, c.parameters);
  const int sizes = (mesh.dx ? 1 : 0) + (mesh.dy ? 1 : 0) + (mesh.dz ? 1 : 0);
  const bool has_corner = mesh.x || mesh.y || mesh.z;
  if (sizes != 3 && (sizes != 0 || has_corner))
    c.report(Code::attribute_needed, mesh, "", {"each of dx, dy and dz", "for bounds"});
}

}  // namespace

void check_parts(Context& c) {
  for (const Part& part : c.document.parts) {
    if (!part.macrostructure && part.steps.empty()) c.report(Code::part_empty, part, "", {part.id.text});
    if (!part.macrostructure && !part.steps.empty() && part.steps.front().operation != ApplyOperation::union_)
      c.report(Code::part_first_union, part.steps.front(), "operation", {text(part.steps.front().operation)});
    for (const Apply& apply : part.steps) check_apply(c, apply);
    if (part.validation) check_validation(c, *part.validation);
  }
  for (const BuildItem& item : c.document.build) {
    check_placement(c, item.placement, c.parameters);
    if (item.mesh) check_mesh(c, *item.mesh);
  }
}

}  // namespace meso
