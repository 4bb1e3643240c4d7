// SPDX-License-Identifier: Apache-2.0
#pragma once
// Small documents, good and bad, that two judges must agree on: the reader and the schema. '^' marks the place of the
// expected diagnostic and is not part of the text.

#include <optional>
#include <string>
#include <vector>

#include "meso/base/diagnostic.hpp"

namespace meso::xml {

enum class SchemaReach { within, beyond };  ///< beyond: a rule that XSD 1.0 cannot say

struct StructureCase {
  std::string name;
  std::string marked_text;
  std::optional<Code> fault;
  SchemaReach reach = SchemaReach::within;
};

/// `body` in a root element.
std::string in_meso(const std::string& body);
/// A unit cell with this content.
std::string in_cell(const std::string& content);

const std::vector<StructureCase>& structure_cases();

}  // namespace meso::xml
