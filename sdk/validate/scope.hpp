// SPDX-License-Identifier: Apache-2.0
#pragma once
// The names that an expression can see, in layers: document, unit cell, pattern.

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace meso {

class Scope {
 public:
  /// `outer` must outlive this scope.
  explicit Scope(const Scope* outer = nullptr) : outer_(outer) {}

  /// `what` says in words what the name is ("the axis 'x'"). A name that is there already stays what it was.
  void add(std::string name, std::string what) { names_.emplace(std::move(name), std::move(what)); }
  void add_all(const Scope& other) {
    names_.insert(other.names_.begin(), other.names_.end());
    open_ = open_ || other.open_;
  }
  /// Every name is seen from now on: a reported fault hides which ones there are.
  void open() { open_ = true; }

  /// What the name is, here or in an outer layer; null if nothing.
  [[nodiscard]] const std::string* find(std::string_view name) const {
    const auto found = names_.find(name);
    if (found != names_.end()) return &found->second;
    return outer_ != nullptr ? outer_->find(name) : nullptr;
  }
  [[nodiscard]] bool sees(std::string_view name) const {
    return open_ || names_.find(name) != names_.end() || (outer_ != nullptr && outer_->sees(name));
  }
  /// Every visible name, innermost first.
  [[nodiscard]] std::vector<std::string_view> names() const {
    std::vector<std::string_view> all;
    for (const Scope* scope = this; scope != nullptr; scope = scope->outer_)
      for (const auto& [name, what] : scope->names_) all.push_back(name);
    return all;
  }

  /// This layer alone.
  [[nodiscard]] Scope without_outer() const {
    Scope copy(*this);
    copy.outer_ = nullptr;
    return copy;
  }
  /// Forgets the names that the layer `other` does not have.
  void keep_only(const Scope& other) {
    if (!other.open_) std::erase_if(names_, [&](const auto& entry) { return !other.names_.contains(entry.first); });
    open_ = open_ && other.open_;
  }

 private:
  const Scope* outer_;
  bool open_ = false;
  std::map<std::string, std::string, std::less<>> names_;
};

}  // namespace meso
