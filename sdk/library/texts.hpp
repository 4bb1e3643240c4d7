// SPDX-License-Identifier: Apache-2.0
#pragma once
// The files of library/ as the build found them, in the order of their names. Private.

#include <array>
#include <string_view>

namespace meso {

struct LibraryText {
  std::string_view name, text;
};
extern const std::array<LibraryText, 9> library_texts;

}  // namespace meso
