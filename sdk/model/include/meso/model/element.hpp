// SPDX-License-Identifier: Apache-2.0
#pragma once
// What every element of a document has besides its own fields, and the small value types attributes are made of.

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace meso {

/// Key of an element in a SourceMap. 0: not read from a file.
struct ElementId {
  std::uint32_t value = 0;
};

/// Verbatim text that the format does not interpret: a comment, a processing instruction or an element of a foreign
/// namespace.
struct Trivia {
  enum class Kind { comment, instruction, foreign };
  Kind kind = Kind::comment;
  std::string text;
  friend bool operator==(const Trivia&, const Trivia&) = default;
};

/// An attribute of a foreign namespace, or a namespace declaration: `name` as written (with prefix), `value` unescaped.
struct ForeignAttribute {
  std::string name;
  std::string value;
  friend bool operator==(const ForeignAttribute&, const ForeignAttribute&) = default;
};

/// Base of every element type. The id and layout never take part in equality.
struct Element {
  ElementId id_in_source{};
  std::vector<Trivia> before;  ///< stands directly before this element
  std::vector<Trivia> inside;  ///< stands behind the last child
  std::vector<ForeignAttribute> foreign;

  friend bool operator==(const Element& a, const Element& b) {
    return a.before == b.before && a.inside == b.inside && a.foreign == b.foreign;
  }
};

/// Text in the expression grammar (docs/specification/expressions.md). Parsed by validate and eval; stored as written.
struct Expression {
  std::string text;
  friend bool operator==(const Expression&, const Expression&) = default;
};

/// Comma-separated expressions: matrix rows, coordinates.
struct ExpressionList {
  std::string text;
  friend bool operator==(const ExpressionList&, const ExpressionList&) = default;
};

/// The name under which an element is known in its document.
struct Id {
  std::string text;
  friend auto operator<=>(const Id&, const Id&) = default;
};

/// The id of an element of type T.
template <class T>
struct Ref {
  std::string text;
  friend auto operator<=>(const Ref&, const Ref&) = default;
};

/// A local name that is not a document-wide id: axis, index, node, component, parameter of a cell.
struct Name {
  std::string text;
  friend auto operator<=>(const Name&, const Name&) = default;
};

/// A path or URI relative to the document.
struct Href {
  std::string text;
  friend bool operator==(const Href&, const Href&) = default;
};

/// A container element such as <patterns>: it may be repeated in a file and is one section in the model.
template <class T>
struct Section : Element {
  std::vector<T> items;
  friend bool operator==(const Section&, const Section&) = default;

  [[nodiscard]] auto begin() const { return items.begin(); }
  [[nodiscard]] auto end() const { return items.end(); }
  [[nodiscard]] auto begin() { return items.begin(); }
  [[nodiscard]] auto end() { return items.end(); }
  [[nodiscard]] bool empty() const { return items.empty(); }
  [[nodiscard]] std::size_t size() const { return items.size(); }
};

}  // namespace meso
