// SPDX-License-Identifier: Apache-2.0
#pragma once
// Document to bytes. read_document(write_document(d)) == d, and canonical_document() is a fixed point of reading and
// writing.

#include <string>

#include "meso/model/document.hpp"

namespace meso {

/// Indented by two spaces, comments and foreign content kept, LF line ends.
[[nodiscard]] std::string write_document(const Document& document);
/// The one byte form of a document's meaning (specification, clause "Canonical form"): for hashes and diffs. Comments
/// are dropped.
[[nodiscard]] std::string canonical_document(const Document& document);

}  // namespace meso
