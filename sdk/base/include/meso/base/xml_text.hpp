// SPDX-License-Identifier: Apache-2.0
#pragma once
// Text as it stands in an XML file.
//
//   escaped_attribute("a < \"b\"") == "a &lt; &quot;b&quot;"   // between double quotes
//   escaped_text("a < b") == "a &lt; b"                        // between tags

#include <string>
#include <string_view>

namespace meso {

[[nodiscard]] std::string escaped_attribute(std::string_view value);
[[nodiscard]] std::string escaped_text(std::string_view value);

}  // namespace meso
