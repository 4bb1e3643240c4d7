// SPDX-License-Identifier: Apache-2.0
#pragma once
// Files that a document refers to: hrefs stay inside the document's folder, and a stated SHA-256 must match.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace meso {

/// The file an href names, or nothing if the href is absolute, has a scheme, is empty, contains a backslash or NUL, or
/// leaves `folder` (also through symbolic links). The file need not exist.
[[nodiscard]] std::optional<std::filesystem::path> resolve_href(const std::filesystem::path& folder,
                                                                std::string_view href);

/// Lower-case hexadecimal SHA-256 of a file's bytes; empty if it cannot be read. Reads in blocks.
[[nodiscard]] std::optional<std::string> sha256_of_file(const std::filesystem::path& file);

}  // namespace meso
