// SPDX-License-Identifier: Apache-2.0
#pragma once
// The names and aliases of the periodic surfaces: from the table that the implicit engine is made of, but without it.

#include <span>
#include <string_view>

namespace meso {

[[nodiscard]] std::span<const std::string_view> surface_names();

}  // namespace meso
