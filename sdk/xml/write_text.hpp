// SPDX-License-Identifier: Apache-2.0
#pragma once
// Text as it stands in a file.

#include <string>
#include <string_view>

namespace meso::xml {

/// White space runs as one space, none at the ends: the canonical spelling of an expression.
[[nodiscard]] std::string collapsed(std::string_view text);
/// At most 100 bytes of a text and "...", for messages.
[[nodiscard]] std::string shortened(std::string_view text);

}  // namespace meso::xml
