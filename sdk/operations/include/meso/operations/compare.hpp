// SPDX-License-Identifier: Apache-2.0
#pragma once
// The size of the idea against the size of the geometry: the columns of Williams et al.'s table of case studies.

#include "meso/operations/convert.hpp"

namespace meso::operations {

struct ComparisonRow {
  std::string name;
  std::uint64_t cells = 0;       ///< kept
  std::uint64_t macro_step = 0;  ///< bytes of the macrostructure alone
  std::uint64_t part_step = 0;
  std::uint64_t part_stl = 0;  ///< ASCII, as in the paper
  std::uint64_t framework =
      0;  ///< all files needed to rebuild the part: document, macrostructure, fields; a shared file once
  std::uint64_t packed = 0;  ///< the same files in one package, .mesoz
  std::uint64_t triangles = 0;
  double deflection_mm = 0, angle_rad = 0;
  Seconds seconds;

  /// Reduction in percent.
  [[nodiscard]] double versus_step() const {
    return 100.0 * (1 - static_cast<double>(framework) / static_cast<double>(part_step));
  }
  [[nodiscard]] double versus_stl() const {
    return 100.0 * (1 - static_cast<double>(framework) / static_cast<double>(part_stl));
  }
};

/// Realises the document and counts bytes; writes no file.
[[nodiscard]] std::optional<ComparisonRow> compare(const std::filesystem::path& document, const MakeOptions& options,
                                                   DiagnosticSink& sink);

/// The document with the value of parameter `id` replaced: a copy that differs in nothing else, byte for byte. Empty
/// (with a diagnostic) if there is no such parameter.
[[nodiscard]] std::optional<std::string> document_with_parameter(const std::filesystem::path& document,
                                                                 const std::string& id, const std::string& value,
                                                                 DiagnosticSink& sink);

}  // namespace meso::operations
