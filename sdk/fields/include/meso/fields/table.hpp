// SPDX-License-Identifier: Apache-2.0
#pragma once
// What every reader of field files gives: named columns of doubles, and where their rows stand if the file says so.
//
// Columns named x, y and z are global Cartesian positions. A file without names (raw, HDF5, CSV without a heading)
// gives columns without names, in the order of the file.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "meso/fields/records.hpp"

namespace meso::fields {

struct Column {
  std::string name;
  std::string unit;  ///< as the file states it; empty if it does not
};

struct Table {
  std::vector<Column> columns;  ///< empty, or one for each column of `records`
  Records records;

  /// Positions along x, y and z of a grid whose rows run x fastest; empty where there is none. `is_regular`: on equal
  /// steps.
  std::array<std::vector<double>, 3> grid;
  bool is_regular = false;
  /// Four and eight rows for each element, counted from 0.
  std::vector<std::int64_t> tetra, hexa;
};

/// A name that expressions can use: letters, digits and _, not beginning with a digit.
[[nodiscard]] std::string column_name(std::string_view text);

}  // namespace meso::fields
