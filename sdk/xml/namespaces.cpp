// SPDX-License-Identifier: Apache-2.0
#include "namespaces.hpp"

#include <utility>

#include "meso/model/document.hpp"

namespace meso::xml {

NamespaceScope::NamespaceScope(std::vector<Binding>& bindings) : bindings_(bindings) {
  numbers_ = {{"", no_namespace},
              {"http://www.w3.org/XML/1998/namespace", xml_namespace},
              {"http://www.w3.org/2000/xmlns/", xmlns_namespace},
              {std::string(meso_namespace), format_namespace}};
  declare("xml", "http://www.w3.org/XML/1998/namespace", Binding::no_element);
}

void NamespaceScope::declare(std::string_view prefix, std::string uri, std::uint32_t element) {
  const auto number = numbers_.try_emplace(uri, static_cast<std::uint32_t>(numbers_.size())).first->second;
  const auto index = static_cast<std::uint32_t>(bindings_.size());
  bindings_.push_back({prefix, std::move(uri), number, element});
  active_.push_back(index);
  by_prefix_[prefix].push_back(index);
}

void NamespaceScope::leave(std::uint32_t element) {
  while (!active_.empty() && bindings_[active_.back()].element == element) {
    by_prefix_[bindings_[active_.back()].prefix].pop_back();
    active_.pop_back();
  }
}

std::uint32_t NamespaceScope::find(std::string_view prefix) const {
  const auto found = by_prefix_.find(prefix);
  return found == by_prefix_.end() || found->second.empty() ? ScannedName::unbound : found->second.back();
}

}  // namespace meso::xml
