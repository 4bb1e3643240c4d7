// SPDX-License-Identifier: Apache-2.0
#pragma once
// The unit cells that every reader knows by name: those of library/*.meso, compiled in.
//
//   if (const UnitCell* bcc = find_library_cell("bcc")) use(bcc->parameters, bcc->body);
//
// A document says `<unitCell id="core" library="bcc">` and names the parameters it wants otherwise. Lengths
// carry their unit, so a cell means the same in documents of any unit. Pointers live as long as the program. The first
// call reads the texts, about a millisecond. Thread rule: safe from several threads.

#include <string_view>
#include <vector>

#include "meso/model/document.hpp"

namespace meso {

/// Null if there is none of that name.
[[nodiscard]] const UnitCell* find_library_cell(std::string_view name);
/// In alphabetical order.
[[nodiscard]] std::vector<std::string_view> library_cell_names();

}  // namespace meso
