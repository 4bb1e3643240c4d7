// SPDX-License-Identifier: Apache-2.0
#pragma once
// The reader as a visitor of the describe table: fills an element from its scope.

#include <algorithm>
#include <string>
#include <utility>

#include "reading.hpp"
#include "value_text.hpp"

namespace meso::xml {

template <class E>
void read_element(Reading& reading, Child& child, std::string path, E& e);

class ReadVisitor {
 public:
  explicit ReadVisitor(ElementScope& scope) : scope_(scope), next_(scope.children().begin()) {}

  template <class T>
  void attribute(std::string_view name, T& value) {
    pugi::xml_attribute tree;
    const ScannedAttribute* scanned = scope_.find_attribute(name, tree);
    if (scanned == nullptr) return;
    if (auto fault = parse_value(name, tree.value(), value))
      scope_.report_value(*scanned, fault->code, std::move(fault->args));
  }

  void text(std::string& value) { value = std::move(scope_.text()); }

  template <class T>
  void child(std::string_view name, std::optional<T>& value) {
    for (; here(); ++next_) read_element(scope_.reading(), *next_, path(name), value.emplace());
    ++slot_;
  }

  template <class T>
  void children(std::string_view name, std::vector<T>& values) {
    values.reserve(static_cast<std::size_t>(std::count_if(next_, scope_.children().end(), in_slot())));
    for (; here(); ++next_) {
      T& value = values.emplace_back();
      read_element(scope_.reading(), *next_, path(name, values.size()), value);
    }
    ++slot_;
  }

  template <class T>
  void sequence(std::vector<T>& values) {
    std::vector<std::size_t> counts;
    for (; here(); ++next_) {
      counts.resize(std::max(counts.size(), next_->alternative + 1));
      const std::size_t number = ++counts[next_->alternative];
      alternative(variant_of(values.emplace_back()), number);
    }
    ++slot_;
  }

  template <class... Ts>
  void choice(std::variant<Ts...>& value) {
    for (; here(); ++next_) alternative(value, 0);
    ++slot_;
  }

  template <class T>
  void section(std::string_view name, Section<T>& section, std::string_view item);

 private:
  [[nodiscard]] auto in_slot() const {
    return [this](const Child& c) { return c.slot == slot_; };
  }
  [[nodiscard]] bool here() const { return next_ != scope_.children().end() && next_->slot == slot_; }
  [[nodiscard]] std::string path(std::string_view name, std::size_t number = 0) const {
    std::string out;
    out.reserve(scope_.path().size() + name.size() + 24);
    out.append(scope_.path()).append("/").append(name);
    if (number != 0) out.append("[").append(std::to_string(number)).append("]");
    return out;
  }

  template <class... Ts>
  void alternative(std::variant<Ts...>& value, std::size_t number) {
    (alternative_of_type<Ts>(value, number), ...);
  }
  template <class T, class Variant>
  void alternative_of_type(Variant& value, std::size_t number) {
    if constexpr (!std::is_same_v<T, std::monostate>) {
      if (scope_.reading().element(next_->node).name.local() == element_name<T>)
        read_element(scope_.reading(), *next_, path(element_name<T>, number), value.template emplace<T>());
    }
  }

  ElementScope& scope_;
  std::vector<Child>::iterator next_;
  std::size_t slot_ = 0;
};

/// The part of an element that every type has.
inline void read_base(ElementScope& scope, std::vector<Trivia> before, Element& e) {
  e.id_in_source = scope.reading().add(scope.node(), scope.path());
  e.before = std::move(before);
  e.inside = std::move(scope.trailing());
  e.foreign = scope.reading().foreign_attributes(scope.node());
}

template <class E>
void read_element(Reading& reading, Child& child, std::string path, E& e) {
  ElementScope scope(reading, child.node, shape_of<E>(), std::move(path));
  read_base(scope, std::move(child.before), e);
  ReadVisitor visitor(scope);
  describe(visitor, e);
}

/// Adds what a further element of a section brings; `pending` stood between the items so far and the new ones.
void merge_section(ElementScope& scope, Element& section, std::vector<Child>& items, std::vector<Trivia> before);

template <class T>
void ReadVisitor::section(std::string_view name, Section<T>& section, std::string_view item) {
  const ElementShape shape{{}, {{SlotKind::repeated, {{item, &shape_of<T>}}}}, false, false};
  for (; here(); ++next_) {
    ElementScope inner(scope_.reading(), next_->node, shape, path(name));
    merge_section(inner, section, inner.children(), std::move(next_->before));
    for (Child& c : inner.children()) {
      T& value = section.items.emplace_back();
      const std::string item_path =
          inner.path() + "/" + std::string(item) + "[" + std::to_string(section.items.size()) + "]";
      read_element(scope_.reading(), c, item_path, value);
    }
  }
  ++slot_;
}

}  // namespace meso::xml
