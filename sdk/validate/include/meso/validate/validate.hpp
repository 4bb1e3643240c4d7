// SPDX-License-Identifier: Apache-2.0
#pragma once
// The rules of the format over a document that has been read: links, cycles, units, ranges, expressions, coordinate
// systems.
//
//   if (auto checked = validate(std::move(read->document), std::move(read->source), folder, sink)) evaluate(*checked);
//
// Reports all independent faults and no consequences of a fault already told. Checks that referenced files exist, opens
// none, never evaluates a pattern; cost is linear in the document.

#include <filesystem>
#include <optional>

#include "meso/base/diagnostic.hpp"
#include "meso/model/checked_document.hpp"

namespace meso {

/// `resources`: where hrefs lead; never null. Empty if any error was reported.
[[nodiscard]] std::optional<CheckedDocument> validate(Document document, SourceMap source,
                                                      std::shared_ptr<const Resources> resources, DiagnosticSink& sink);
/// Hrefs are relative to `folder`.
[[nodiscard]] std::optional<CheckedDocument> validate(Document document, SourceMap source,
                                                      const std::filesystem::path& folder, DiagnosticSink& sink);

}  // namespace meso
