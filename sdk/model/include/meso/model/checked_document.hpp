// SPDX-License-Identifier: Apache-2.0
#pragma once
// A document that validation has accepted. Only `validate` makes one; evaluation and the engines accept nothing else.

#include <memory>

#include "meso/model/document.hpp"
#include "meso/model/source_map.hpp"
#include "meso/resource/resource.hpp"

namespace meso {

/// A Document, its source map and where its hrefs lead. Cheap to copy, immutable.
class CheckedDocument {
 public:
  [[nodiscard]] const Document& document() const { return *document_; }
  [[nodiscard]] const SourceMap& source() const { return *source_; }
  [[nodiscard]] const Resources& resources() const { return *resources_; }

 private:
  friend class Validator;
  CheckedDocument(std::shared_ptr<const Document> document, std::shared_ptr<const SourceMap> source,
                  std::shared_ptr<const Resources> resources)
      : document_(std::move(document)), source_(std::move(source)), resources_(std::move(resources)) {}

  std::shared_ptr<const Document> document_;
  std::shared_ptr<const SourceMap> source_;
  std::shared_ptr<const Resources> resources_;
};

}  // namespace meso
