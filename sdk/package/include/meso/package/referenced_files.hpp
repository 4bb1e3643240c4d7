// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a document needs besides itself.

#include <string>
#include <vector>

#include "meso/model/checked_document.hpp"

namespace meso {

struct ReferencedFile {
  /// One element that refers to the file.
  struct Use {
    ElementId element;
    bool has_sha256 = false;
  };
  std::string name;  ///< its one name inside the folder or package, as normalized_href() gives it
  Resource resource;
  std::vector<Use> uses;
};

/// Each file once, in order of first use.
[[nodiscard]] std::vector<ReferencedFile> referenced_files(const CheckedDocument& checked);

}  // namespace meso
