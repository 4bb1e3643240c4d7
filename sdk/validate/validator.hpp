// SPDX-License-Identifier: Apache-2.0
#pragma once
// The one class that may make a CheckedDocument.

#include <optional>

#include "meso/base/diagnostic.hpp"
#include "meso/model/checked_document.hpp"

namespace meso {

class Validator {
 public:
  /// Runs all families of rules in order; empty if any of them reported an error.
  [[nodiscard]] static std::optional<CheckedDocument> run(Document document, SourceMap source,
                                                          std::shared_ptr<const Resources> resources,
                                                          DiagnosticSink& sink);
};

}  // namespace meso
