// SPDX-License-Identifier: Apache-2.0
#pragma once
// What all families of rules share: the document, the table of its ids, the values of its parameters, and the pen that
// writes diagnostics. A family asks with find() and constant(), which answer nothing where a fault was already told, so
// that no consequence of a fault is reported.

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "meso/base/diagnostic.hpp"
#include "meso/base/number.hpp"
#include "meso/model/document.hpp"
#include "meso/model/source_map.hpp"
#include "meso/resource/resource.hpp"
#include "scope.hpp"

namespace meso {

enum class Kind { parameter, coordinate_system, macrostructure, unit_cell, vector_field, pattern, part };

/// What each kind of element is called and where its elements stand.
template <class T>
struct KindOf;
#define MESO_KIND(Type, Enumerator, Section)                                \
  template <>                                                               \
  struct KindOf<Type> {                                                     \
    static constexpr Kind kind = Kind::Enumerator;                          \
    static const auto& items(const Document& d) { return d.Section.items; } \
  }
MESO_KIND(Parameter, parameter, parameters);
MESO_KIND(CoordinateSystem, coordinate_system, coordinate_systems);
MESO_KIND(Macrostructure, macrostructure, macrostructures);
MESO_KIND(UnitCell, unit_cell, unit_cells);
MESO_KIND(VectorField, vector_field, vector_fields);
MESO_KIND(Pattern, pattern, patterns);
MESO_KIND(Part, part, parts);
#undef MESO_KIND

[[nodiscard]] std::string_view to_text(Kind kind);

class Context {
 public:
  Context(const Document& d, const SourceMap& s, const Resources& r, DiagnosticSink& sink)
      : document(d), source(s), resources(r), sink_(sink) {}

  const Document& document;
  const SourceMap& source;
  const Resources& resources;

  struct Entry {
    Kind kind{};
    std::size_t index = 0;  ///< in its section
    const Element* element = nullptr;
    bool is_forgotten = false;  ///< nothing can be said about it: find() does not know it
  };
  std::map<std::string, Entry, std::less<>> ids;
  /// The document's parameters, the outermost scope.
  Scope parameters;
  /// Those of them that have a value.
  std::map<std::string, double, std::less<>> values;

  template <class T>
  [[nodiscard]] const T* find(const Ref<T>& ref) const {
    const auto found = ids.find(ref.text);
    if (found == ids.end() || found->second.kind != KindOf<T>::kind || found->second.is_forgotten) return nullptr;
    return &KindOf<T>::items(document)[found->second.index];
  }
  template <class T>
  [[nodiscard]] const T* find(const std::optional<Ref<T>>& ref) const {
    return ref ? find(*ref) : nullptr;
  }

  template <class T>
  void forget(const T& item) {
    if (const auto found = ids.find(item.id.text); found != ids.end()) found->second.is_forgotten = true;
  }

  /// A fault of an element, of one of its attributes, or of some bytes of the attribute's value.
  void report(Code code, const Element& element, std::string_view attribute, std::vector<std::string> args,
              std::size_t offset = 0, std::size_t length = 0);
  void report_with_related(Code code, const Element& element, std::string_view attribute, std::vector<std::string> args,
                           const Element& related, std::string_view related_attribute, std::string note);

  /// the grammar, the names, and the value if it has only parameters. False if reported.
  bool check(const Element& element, std::string_view attribute, const Expression& expression, const Scope& scope);
  bool check(const Element& element, std::string_view attribute, const ExpressionList& list, const Scope& scope);
  template <class T>
  bool check(const Element& element, std::string_view attribute, const std::optional<T>& expression,
             const Scope& scope) {
    return !expression || check(element, attribute, *expression, scope);
  }

  /// The value of an expression of document parameters, if it has one. Reports nothing.
  [[nodiscard]] std::optional<double> constant(const Expression& expression) const;
  /// The fallback if the attribute is absent.
  [[nodiscard]] std::optional<double> constant(const std::optional<Expression>& expression, double fallback) const {
    return expression ? constant(*expression) : fallback;
  }
  /// All items' values, or nothing if one has none.
  [[nodiscard]] std::optional<std::vector<double>> constants(const ExpressionList& list) const;

  /// "; did you mean 'core'?" or nothing.
  [[nodiscard]] std::string suggestion(std::string_view word, std::span<const std::string_view> candidates) const;
  /// The same, or all candidates where they are few and none is near: "; its parameters: core, wall".
  [[nodiscard]] std::string suggestion_or_list(std::string_view word, std::span<const std::string_view> candidates,
                                               std::string_view plural) const;
  /// The sink takes no more: costly words can be saved.
  [[nodiscard]] bool is_full() const { return sink_.truncated(); }

  // Ranges of constant values; nothing to say about others.
  void require_positive(const Element& element, std::string_view attribute, const std::optional<Expression>& value);
  void require_not_negative(const Element& element, std::string_view attribute, const std::optional<Expression>& value);
  /// Three components that are constant and all zero.
  [[nodiscard]] bool is_zero(const std::optional<Expression>& x, const std::optional<Expression>& y,
                             const std::optional<Expression>& z) const;

  ///
  bool check_name(const Element& element, std::string_view attribute, std::string_view name);
  /// adds a name to a scope, or reports that it is taken.
  void declare(Scope& scope, const Element& element, std::string_view attribute, std::string_view name,
               std::string what);

 private:
  bool check_text(const Element& element, std::string_view attribute, std::string_view text, std::size_t offset,
                  const Scope& scope);

  DiagnosticSink& sink_;
};

}  // namespace meso
