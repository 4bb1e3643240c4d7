// SPDX-License-Identifier: Apache-2.0
#pragma once
// The describe table as data: which attributes and children an element type may have, by name.
//
//   const ElementShape& loop = shape_of<Loop>();   // attributes index, count, axis ...; no children
//
// Computed once per type from describe(); cheap afterwards, thread-safe.

#include <optional>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "meso/model/describe.hpp"

namespace meso::xml {

template <class T>
inline constexpr bool is_optional = false;
template <class T>
inline constexpr bool is_optional<std::optional<T>> = true;

template <class T>
struct ValueOf {
  using type = T;
};
template <class T>
struct ValueOf<std::optional<T>> {
  using type = T;
};
/// T of optional<T>, else T.
template <class T>
using value_of = typename ValueOf<std::remove_const_t<T>>::type;

/// The variant of a CSG operand (wrapped, because operands are recursive) or of an instruction.
template <class T>
auto& variant_of(T& item) {
  if constexpr (requires { item.value; })
    return item.value;
  else
    return item;
}

enum class ValueKind { id, reference, name, expression, expressions, href, text, number, integer, boolean, choice };

struct AttributeShape {
  std::string_view name;
  bool required = false;
  ValueKind kind = ValueKind::text;
  std::vector<std::string_view> choices;
};

struct ElementShape;
struct Alternative {
  std::string_view name;
  const ElementShape& (*shape)();
};
enum class SlotKind { single, repeated, sequence, choice, section };
struct Slot {
  SlotKind kind;
  std::vector<Alternative> alternatives;
  [[nodiscard]] bool has(std::string_view name) const {
    for (const Alternative& a : alternatives)
      if (a.name == name) return true;
    return false;
  }
};

struct ElementShape {
  std::vector<AttributeShape> attributes;
  std::vector<Slot> slots;
  bool has_text = false;
  bool any_order = false;  ///< of the root: children in any order
};

template <class E>
const ElementShape& shape_of();

template <class T>
constexpr ValueKind value_kind() {
  if constexpr (std::is_same_v<T, Id>)
    return ValueKind::id;
  else if constexpr (std::is_same_v<T, Name>)
    return ValueKind::name;
  else if constexpr (std::is_same_v<T, Expression>)
    return ValueKind::expression;
  else if constexpr (std::is_same_v<T, ExpressionList>)
    return ValueKind::expressions;
  else if constexpr (std::is_same_v<T, Href>)
    return ValueKind::href;
  else if constexpr (std::is_same_v<T, std::string>)
    return ValueKind::text;
  else if constexpr (std::is_same_v<T, double>)
    return ValueKind::number;
  else if constexpr (std::is_same_v<T, std::int64_t>)
    return ValueKind::integer;
  else if constexpr (std::is_same_v<T, bool>)
    return ValueKind::boolean;
  else if constexpr (std::is_enum_v<T>)
    return ValueKind::choice;
  else
    return ValueKind::reference;
}

/// Visitor that fills an ElementShape.
class ShapeVisitor {
 public:
  explicit ShapeVisitor(ElementShape& shape) : shape_(shape) {}

  template <class T>
  void attribute(std::string_view name, T&) {
    using Value = value_of<T>;
    AttributeShape a{name, !is_optional<T>, value_kind<Value>(), {}};
    if constexpr (std::is_enum_v<Value>) a.choices.assign(enum_texts<Value>.begin(), enum_texts<Value>.end());
    shape_.attributes.push_back(std::move(a));
  }
  void text(const std::string&) { shape_.has_text = true; }
  template <class T>
  void child(std::string_view name, T&) {
    static_assert(is_optional<T>, "required children would need a diagnostic of their own");
    shape_.slots.push_back({SlotKind::single, {{name, &shape_of<value_of<T>>}}});
  }
  template <class T>
  void children(std::string_view name, std::vector<T>&) {
    shape_.slots.push_back({SlotKind::repeated, {{name, &shape_of<T>}}});
  }
  template <class T>
  void sequence(std::vector<T>&) {
    using Variant = std::remove_reference_t<decltype(variant_of(std::declval<T&>()))>;
    shape_.slots.push_back({SlotKind::sequence, alternatives(static_cast<Variant*>(nullptr))});
  }
  template <class... Ts>
  void choice(std::variant<Ts...>& variant) {
    shape_.slots.push_back({SlotKind::choice, alternatives(&variant)});
  }
  template <class T>
  void section(std::string_view name, Section<T>&, std::string_view item) {
    // One section type per item type, so the first item name is the only one.
    static const std::string_view item_name = item;
    constexpr auto shape = []() -> const ElementShape& {
      static const ElementShape s{{}, {{SlotKind::repeated, {{item_name, &shape_of<T>}}}}, false, false};
      return s;
    };
    shape_.slots.push_back({SlotKind::section, {{name, shape}}});
    shape_.any_order = true;
  }

 private:
  template <class... Ts>
  static std::vector<Alternative> alternatives(std::variant<Ts...>*) {
    std::vector<Alternative> out;
    (add_alternative<Ts>(out), ...);
    return out;
  }
  template <class T>
  static void add_alternative(std::vector<Alternative>& out) {
    if constexpr (!std::is_same_v<T, std::monostate>) out.push_back({element_name<T>, &shape_of<T>});
  }

  ElementShape& shape_;
};

template <class E>
const ElementShape& shape_of() {
  static const ElementShape shape = [] {
    ElementShape s;
    ShapeVisitor visitor(s);
    E element;
    describe(visitor, element);
    return s;
  }();
  return shape;
}

}  // namespace meso::xml
