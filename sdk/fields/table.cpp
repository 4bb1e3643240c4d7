// SPDX-License-Identifier: Apache-2.0
#include "meso/fields/table.hpp"

namespace meso::fields {

std::string column_name(std::string_view text) {
  std::string name;
  for (const char c : text) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'), is_digit = c >= '0' && c <= '9';
    if (is_digit && name.empty()) name += '_';
    name += is_letter || is_digit ? c : '_';
  }
  return name.empty() ? "_" : name;
}

}  // namespace meso::fields
