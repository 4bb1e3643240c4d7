// SPDX-License-Identifier: Apache-2.0
#pragma once
// A table as the vector field of a document. Private.

#include "meso/fields/table.hpp"
#include "meso/model/document.hpp"

namespace meso::operations {

/// One <vectorField> with this id. REQUIRES: columns with names.
[[nodiscard]] Document field_document(const fields::Table& table, const std::string& id, const std::string& unit);

}  // namespace meso::operations
