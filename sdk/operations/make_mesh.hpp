// SPDX-License-Identifier: Apache-2.0
#pragma once
// A document through the implicit engine: fields of its parts, a grid, a mesh file. Private.

#include "meso/implicit/document_field.hpp"
#include "meso/operations/convert.hpp"

namespace meso::operations {

/// Reads and evaluates, without asking for what only exact bodies need.
[[nodiscard]] std::optional<eval::Evaluation> open_document(const std::filesystem::path& document,
                                                            const MakeOptions& options, Seconds& seconds,
                                                            DiagnosticSink& sink);

/// Contours what is built (or the part that is asked for) into the file.
[[nodiscard]] std::optional<ConvertReport> make_mesh(const eval::Evaluation& evaluation,
                                                     const std::filesystem::path& out, const MakeOptions& options,
                                                     const WriteOptions& write, DiagnosticSink& sink);

/// Why the exact engine cannot make what is built; empty if nothing speaks against it.
[[nodiscard]] std::string reason_for_fields(const eval::Evaluation& evaluation, const std::string& part);

}  // namespace meso::operations
