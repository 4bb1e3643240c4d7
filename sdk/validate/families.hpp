// SPDX-License-Identifier: Apache-2.0
#pragma once
// The families of rules, one file each, in the order in which the validator runs them.

#include <array>
#include <map>
#include <vector>

#include "context.hpp"

namespace meso {

/// fills the table of ids.
void collect_ids(Context& c);
/// unit cells of the library get its parameters, box and body. `document` is the context's.
void fill_library_cells(Context& c, Document& document);
/// references, files, sums.
void check_links(Context& c);
///
void check_cycles(Context& c);
/// fills the outermost scope and the values.
void check_parameters(Context& c);
///
void check_coordinate_systems(Context& c);
///
void check_macrostructures(Context& c);
///
void check_unit_cells(Context& c);
///
void check_fields(Context& c);
///
void check_patterns(Context& c);
///
void check_parts(Context& c);
/// written units suit each other and what they are written for. Last: it asks for the kinds
/// of axes and says nothing about what the other families told.
void check_dimensions(Context& c);

// Shared by several families.

/// A visitor for walk(): every single expression, all in one scope. Lists are left to those who know their length.
struct ExpressionCheck {
  Context& c;
  const Scope& scope;

  template <class T>
  void operator()(const Element&, std::string_view, const T&) const {}
  void operator()(const Element& element, std::string_view attribute, const Expression& expression) const {
    if (attribute == "nodeRadius" && expression.text == "auto") return;  // a word, not a name
    (void)c.check(element, attribute, expression, scope);
  }
};

/// Items of a comma-separated list.
[[nodiscard]] std::size_t split_count(const ExpressionList& list);
/// every constant of the list is a whole number >= `least`.
void require_whole(Context& c, const Element& element, std::string_view attribute, const ExpressionList& list,
                   double least);
/// a constant value keeps to min and max.
void check_bounds(Context& c, const Element& element, std::string_view attribute, const Expression& expression,
                  std::string_view name, const std::optional<Expression>& min, const std::optional<Expression>& max);
///
void check_bounds_order(Context& c, const Element& element, const std::optional<Expression>& min,
                        const std::optional<Expression>& max);

/// twelve entries and the determinant.
void check_transform(Context& c, const Element& element, const ExpressionList& matrix, std::optional<bool> mirror,
                     const Scope& scope);
void check_placement(Context& c, const std::optional<Placement>& placement, const Scope& scope);

/// bodies in the scope of their owner.
void check_csg(Context& c, const CsgBody& body, const Scope& scope);
void check_import(Context& c, const ImportBody& body, const Scope& scope);
/// one factor or three, all positive.
void check_scale(Context& c, const Element& element, const std::optional<Expression>& x,
                 const std::optional<Expression>& y, const std::optional<Expression>& z,
                 const std::optional<Expression>& factor);
///
void check_beams(Context& c, const BeamsBody& body, const Scope& scope);

/// The axes of a system; of the global one if `ref` is absent; null if the link is broken.
[[nodiscard]] const std::vector<Axis>* axes_of(const Context& c, const std::optional<Ref<CoordinateSystem>>& ref);
/// the place of an axis in its system.
[[nodiscard]] std::optional<std::size_t> find_axis(Context& c, const std::vector<Axis>& axes, std::string_view system,
                                                   const Element& element, std::string_view attribute,
                                                   const Name& name);

/// The names under which expressions know the components of a field and what follows from them (without the field's
/// id).
[[nodiscard]] std::vector<std::string> component_names(const VectorField& field);

}  // namespace meso
