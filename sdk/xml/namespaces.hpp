// SPDX-License-Identifier: Apache-2.0
#pragma once
// Which namespace a prefix means at a place of the file.

#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "scan.hpp"

namespace meso::xml {

/// Constant time per declaration and look-up, however many are in force.
class NamespaceScope {
 public:
  explicit NamespaceScope(std::vector<Binding>& bindings);

  void declare(std::string_view prefix, std::string uri, std::uint32_t element);
  /// Ends the declarations that `element` made.
  void leave(std::uint32_t element);
  /// Index into the bindings, or ScannedName::unbound.
  [[nodiscard]] std::uint32_t find(std::string_view prefix) const;

 private:
  std::vector<Binding>& bindings_;
  std::vector<std::uint32_t> active_;
  std::unordered_map<std::string_view, std::vector<std::uint32_t>> by_prefix_;
  std::unordered_map<std::string, std::uint32_t> numbers_;
};

}  // namespace meso::xml
