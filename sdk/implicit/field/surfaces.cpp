// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/surfaces.hpp"

#include <vector>

#include "meso/expr/nearest.hpp"

namespace meso::implicit {

namespace {

std::string_view without_prefix(std::string_view name) {
  constexpr std::string_view prefix = "tpms.";
  return name.starts_with(prefix) ? name.substr(prefix.size()) : name;
}

/// Calls back with every name and alias; stops where that answers true.
template <class F>
void for_each_name(const Surface& surface, F f) {
  if (f(surface.name)) return;
  std::string_view rest = surface.aliases;
  while (!rest.empty()) {
    const std::size_t end = rest.find(' ');
    if (f(rest.substr(0, end))) return;
    rest = end == std::string_view::npos ? std::string_view{} : rest.substr(end + 1);
  }
}

}  // namespace

const Surface* find_surface(std::string_view name) {
  const std::string_view wanted = without_prefix(name);
  for (const Surface& surface : surfaces()) {
    bool found = false;
    for_each_name(surface, [&](std::string_view candidate) { return found = candidate == wanted; });
    if (found) return &surface;
  }
  return nullptr;
}

std::string_view nearest_surface(std::string_view name) {
  std::vector<std::string_view> candidates;
  for (const Surface& surface : surfaces())
    for_each_name(surface, [&](std::string_view candidate) {
      candidates.push_back(candidate);
      return false;
    });
  return expr::nearest(without_prefix(name), candidates);
}

}  // namespace meso::implicit
