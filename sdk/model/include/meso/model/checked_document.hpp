// SPDX-License-Identifier: Apache-2.0
#pragma once
// A document that validation has accepted. Only `validate` makes one; evaluation and the engines accept nothing else.

#include <filesystem>
#include <memory>

#include "meso/model/document.hpp"
#include "meso/model/source_map.hpp"

namespace meso {

/// A Document, its source map and the folder its hrefs are relative to. Cheap to copy, immutable.
class CheckedDocument {
 public:
  [[nodiscard]] const Document& document() const { return *document_; }
  [[nodiscard]] const SourceMap& source() const { return *source_; }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  friend class Validator;
  CheckedDocument(std::shared_ptr<const Document> document, std::shared_ptr<const SourceMap> source,
                  std::filesystem::path folder)
      : document_(std::move(document)), source_(std::move(source)), folder_(std::move(folder)) {}

  std::shared_ptr<const Document> document_;
  std::shared_ptr<const SourceMap> source_;
  std::filesystem::path folder_;
};

}  // namespace meso
