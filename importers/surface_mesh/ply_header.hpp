// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a PLY file says about itself before its data begin.

#include <optional>
#include <string>
#include <vector>

#include "text_scanner.hpp"

namespace meso {

enum class PlyFormat { ascii, little_endian, big_endian };
enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

[[nodiscard]] constexpr std::size_t bytes_of(PlyType t) {
  return t <= PlyType::uint8 ? 1 : t <= PlyType::uint16 ? 2 : t <= PlyType::float32 ? 4 : 8;
}
[[nodiscard]] constexpr bool is_whole(PlyType t) { return t < PlyType::float32; }

struct PlyProperty {
  std::string name;
  PlyType type{};
  std::optional<PlyType> count_type{};  ///< of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties{};

  /// What one of them takes at the least, every list empty.
  [[nodiscard]] std::uint64_t least_bytes(PlyFormat format) const;
  [[nodiscard]] bool has_lists() const;
  [[nodiscard]] std::optional<std::size_t> find(std::string_view property) const;
};

struct PlyHeader {
  PlyFormat format{};
  std::vector<PlyElement> elements;
};

/// Leaves the scanner at the first byte of the data.
[[nodiscard]] std::optional<PlyHeader> read_ply_header(TextScanner& scanner, DiagnosticSink& sink);

}  // namespace meso
