// SPDX-License-Identifier: Apache-2.0
#pragma once
// What both forms of VTK files gather, and the table that it becomes. Private.

#include <optional>
#include <string>
#include <vector>

#include "meso/fields/file_cursor.hpp"
#include "meso/fields/table.hpp"

namespace meso::vtk {

struct Array {
  std::string name;
  std::size_t width = 1;
  std::vector<double> values;
};
struct Content {
  std::vector<double> places;  ///< x y z
  std::array<std::vector<double>, 3> grid;
  bool is_regular = false;
  std::vector<std::int64_t> offsets, connectivity, types;  ///< cell i: connectivity[offsets[i], offsets[i + 1])
  std::vector<Array> arrays;
};

/// Nothing if something does not fit; reported through `in`.
[[nodiscard]] std::optional<fields::Table> make_table(Content content, const std::string& wanted,
                                                      fields::FileCursor& in);

}  // namespace meso::vtk
