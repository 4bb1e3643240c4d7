// SPDX-License-Identifier: Apache-2.0
#pragma once
// From a document's file to what the engine starts with: evaluated, and how fine its triangles shall be. Private.

#include "meso/operations/convert.hpp"

namespace meso::operations {

struct Prepared {
  eval::Evaluation evaluation;
  brep::RealiseOptions realise;
  std::string part_id;  ///< empty: the document's build
  Seconds seconds;      ///< read and evaluate

  [[nodiscard]] std::optional<std::string_view> part() const {
    return part_id.empty() ? std::nullopt : std::optional<std::string_view>(part_id);
  }
};

[[nodiscard]] std::optional<Prepared> prepare(const std::filesystem::path& document, const MakeOptions& options,
                                              DiagnosticSink& sink);

/// False: it is a body, reported.
[[nodiscard]] bool check_is_document(const std::filesystem::path& in, DiagnosticSink& sink);

/// Smallest edge of the boxes of the patterns' first cells, in millimetres.
[[nodiscard]] std::optional<double> smallest_cell_edge(const eval::Evaluation& evaluation);

}  // namespace meso::operations
