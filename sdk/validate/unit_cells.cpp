// SPDX-License-Identifier: Apache-2.0
// macrostructures and unit cells, what they need and what their expressions see.
#include <algorithm>

#include "families.hpp"
#include "meso/model/walk.hpp"
#include "surface_names.hpp"

namespace meso {
namespace {

/// Document parameters, then the cell's own; in implicit bodies also x y z. Names were checked where they are declared.
Scope body_scope(const Context& c, const UnitCell& cell) {
  Scope scope(&c.parameters);
  for (const CellParameter& p : cell.parameters) scope.add(p.name.text, "a parameter of the cell");
  return scope;
}

void check_parameter_names(Context& c, const UnitCell& cell) {
  Scope names(&c.parameters);
  for (const CellParameter& p : cell.parameters) {
    if (c.check_name(p, "id", p.name.text))
      c.declare(names, p, "id", p.name.text, "a parameter of the unit cell '" + cell.id.text + "'");
    check_bounds_order(c, p, p.min, p.max);
  }
}

void check_box(Context& c, const CellBox& box, const Scope& scope) {
  walk(box, ExpressionCheck{c, scope});
  c.require_positive(box, "dx", box.dx);
  c.require_positive(box, "dy", box.dy);
  c.require_positive(box, "dz", box.dz);
}

template <class Body>
void check_surface(Context& c, const Body& body) {
  std::string_view name = *body.surface;
  constexpr std::string_view prefix = "tpms.";  // as the command language writes it
  if (name.starts_with(prefix)) name.remove_prefix(prefix.size());
  const auto known = surface_names();
  if (std::ranges::find(known, name) == known.end())
    c.report(Code::implicit_unknown_surface, body, "surface", {*body.surface, c.suggestion(name, known)});
}

/// of values that are known.
void require_share(Context& c, const Element& element, std::string_view attribute,
                   const std::optional<Expression>& share, bool may_be_whole) {
  const auto value = share ? c.constant(*share) : std::nullopt;
  if (!value || (*value > 0 && *value < 1) || (may_be_whole && (*value == 0 || *value == 1))) return;
  c.report(Code::value_outside, element, attribute,
           {std::string(attribute), may_be_whole ? "from 0 to 1" : "between 0 and 1", format_number(*value)});
}

/// One of them says what the function is.
template <class Body>
void check_function(Context& c, const Body& body) {
  if (body.field.has_value() == body.surface.has_value())
    c.report(Code::choice_needed, body, "", {"field and surface", body.field ? "both" : "none"});
  if (body.surface) check_surface(c, body);
}

/// what says where the surface runs.
void check_levels(Context& c, const ImplicitBody& body) {
  const ImplicitKind kind = body.kind.value_or(ImplicitKind::endoskeleton);
  const bool is_shell = kind == ImplicitKind::shell;
  const std::string with_kind =
      "with kind=\"" + std::string(enum_texts<ImplicitKind>[static_cast<std::size_t>(kind)]) + "\"";
  if (is_shell) {
    const int given = (body.thickness ? 1 : 0) + (body.wall ? 1 : 0) + (body.density ? 1 : 0);
    if (given > 1) c.report(Code::choice_needed, body, "", {"thickness, wall and density", given == 2 ? "two" : "all"});
  } else if (body.wall) {
    c.report(Code::attribute_ineffective, body, "wall", {"wall", with_kind});
  }
  if (body.density && kind == ImplicitKind::eccentric_shell)
    c.report(Code::attribute_ineffective, body, "density", {"density", with_kind});
  else if (body.density && body.isovalue && !is_shell)
    c.report(Code::attribute_ineffective, body, "isovalue", {"isovalue", "beside density, which says where it is"});
  c.require_positive(body, "thickness", body.thickness);
  c.require_positive(body, "wall", body.wall);
  require_share(c, body, "density", body.density, false);
}

void check_implicit(Context& c, const UnitCell& cell, const ImplicitBody& body, const Scope& outer) {
  Scope scope(&outer);
  for (const char* name : {"x", "y", "z"}) {
    if (const std::string* taken = outer.find(name))
      c.report(Code::name_duplicate, body, "", {name, *taken, "the coordinate " + std::string(name)});
    scope.add(name, "a coordinate of the cell");
  }
  walk(body, ExpressionCheck{c, scope});
  check_function(c, body);
  for (const ImplicitBlend& blend : body.blends) {
    check_function(c, blend);
    require_share(c, blend, "weight", blend.weight, true);
  }
  check_levels(c, body);
  if (!cell.box) c.report(Code::box_needed, cell, "", {cell.id.text, "implicit bodies are cut to it"});
}

void check_body(Context& c, const UnitCell& cell, const Scope& scope) {
  // one of the library has a body, unless its name is wrong.
  if (std::holds_alternative<std::monostate>(cell.body) && !cell.library)
    c.report(Code::content_needed, cell, "", {"unitCell", "a body", "none"});
  if (const auto* csg = std::get_if<CsgBody>(&cell.body)) check_csg(c, *csg, scope);
  if (const auto* beams = std::get_if<BeamsBody>(&cell.body)) check_beams(c, *beams, scope);
  if (const auto* implicit = std::get_if<ImplicitBody>(&cell.body)) check_implicit(c, cell, *implicit, scope);
  if (const auto* import = std::get_if<ImportBody>(&cell.body)) check_import(c, *import, scope);
}

}  // namespace

void check_macrostructures(Context& c) {
  for (const Macrostructure& m : c.document.macrostructures) {
    check_placement(c, m.placement, c.parameters);
    if (std::holds_alternative<std::monostate>(m.body))
      c.report(Code::content_needed, m, "", {"macrostructure", "a body", "none"});
    if (const auto* csg = std::get_if<CsgBody>(&m.body)) check_csg(c, *csg, c.parameters);
    if (const auto* import = std::get_if<ImportBody>(&m.body)) check_import(c, *import, c.parameters);
  }
}

void check_unit_cells(Context& c) {
  for (const UnitCell& cell : c.document.unit_cells) {
    check_parameter_names(c, cell);
    const Scope scope = body_scope(c, cell);
    if (cell.box) check_box(c, *cell.box, scope);
    check_body(c, cell, scope);
    if (cell.clip_to_box.value_or(false) && !cell.box)
      c.report(Code::box_needed, cell, "clipToBox", {cell.id.text, "clipToBox cuts at it"});
  }
}

}  // namespace meso
