// SPDX-License-Identifier: Apache-2.0
#pragma once
// What both forms of VTK files gather, and the table that it becomes. Private.

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "meso/fields/file_cursor.hpp"
#include "meso/fields/table.hpp"

namespace meso::vtk {

/// A number of a point or a place in a list; -1, which no list has, where a file has something else there.
template <class T>
[[nodiscard]] std::int64_t whole_number(T value) {
  if constexpr (std::is_floating_point_v<T>) {
    constexpr double largest = 9007199254740992;  // 2^53
    return std::abs(static_cast<double>(value)) < largest && value == std::trunc(value)
               ? static_cast<std::int64_t>(value)
               : -1;
  } else {
    return static_cast<std::int64_t>(value) < 0 ? -1 : static_cast<std::int64_t>(value);
  }
}

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
  bool has_cell_values = false;  ///< which are left out
};

/// Nothing if something does not fit; reported through `in`.
[[nodiscard]] std::optional<fields::Table> make_table(Content content, const std::string& wanted,
                                                      fields::FileCursor& in);

}  // namespace meso::vtk
