// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "meso/base/diagnostic.hpp"

namespace meso::operations {

/// Bytes of one ZIP archive (deflate, best) that holds the files. Made in memory; REQUIRES: files of moderate size.
[[nodiscard]] std::optional<std::uint64_t> packed_size(const std::vector<std::filesystem::path>& files,
                                                       DiagnosticSink& sink);

}  // namespace meso::operations
