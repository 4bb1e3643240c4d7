// SPDX-License-Identifier: Apache-2.0
#pragma once
// Visits every attribute of an element and of all elements below it, in the order of the describe table.
//
//   walk(part, [](const Element& owner, std::string_view name, const auto& value) { ... });
//
// The owner has the type of its element: `const auto& owner` knows which one it is.

#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "meso/model/describe.hpp"

namespace meso {

template <class Owner, class F>
class Walk {
 public:
  Walk(const Owner& element, F& on) : element_(element), on_(on) {}

  template <class T>
  void attribute(std::string_view name, const T& value) {
    on_(element_, name, value);
  }
  template <class T>
  void attribute(std::string_view name, const std::optional<T>& value) {
    if (value) on_(element_, name, *value);
  }
  void text(const std::string&) {}
  template <class E>
  void child(std::string_view, const E& e) {
    visit(e);
  }
  template <class E>
  void children(std::string_view, const std::vector<E>& all) {
    for (const E& e : all) visit(e);
  }
  template <class E>
  void sequence(const std::vector<E>& all) {
    for (const E& e : all) choice(e);
  }
  template <class... Es>
  void choice(const std::variant<Es...>& alternatives) {
    std::visit([this](const auto& e) { visit(e); }, alternatives);
  }
  void choice(const CsgNode& node) { choice(node.value); }
  template <class E>
  void section(std::string_view, const Section<E>& all, std::string_view) {
    for (const E& e : all) visit(e);
  }

 private:
  void visit(std::monostate) {}
  template <class E>
  void visit(const std::optional<E>& e) {
    if (e) visit(*e);
  }
  template <class E>
  requires std::is_base_of_v<Element, E>
  void visit(const E& e) {
    Walk<E, F> inner(e, on_);
    describe(inner, e);
  }

  const Owner& element_;
  F& on_;
};

template <class E, class F>
void walk(const E& element, F&& on) {
  Walk visitor(element, on);
  describe(visitor, element);
}

}  // namespace meso
