// SPDX-License-Identifier: Apache-2.0
#pragma once
// Ambiguous faces whose inside corners belong together, and the cells that have such faces.
//
// Nielson and Hamann's asymptotic decider: the bilinear interpolant of the four corners is negative at its saddle if
// and only if the product of the inside values exceeds that of the outside values. Products of two floats are exact in
// double, so the cells on both sides of a face cannot disagree.

#include <vector>

#include "brick_record.hpp"
#include "sample_rows.hpp"

namespace meso::implicit {

/// The four rows of nodes around a row of cells.
struct CellRows {
  SampleRow a, b, c, d;  ///< (j - 1, k - 1), (j, k - 1), (j - 1, k), (j, k)
};

class JoinedFaces {
 public:
  void begin_brick();
  void begin_plane();
  void begin_row() { row_.clear(); }

  /// Looks at the faces whose last corners are the nodes of word `w` of row d. A brick needs those across z in the
  /// plane before it, too.
  void find_across_z(const CellRows& rows, std::uint32_t j, std::size_t w);
  void find_across_x_and_y(const CellRows& rows, std::size_t w);

  /// Appends this row's cells to `cells`, ascending.
  void collect(std::uint32_t j, std::uint32_t row, std::vector<JoinedCell>& cells) {
    const bool none = row_.empty() && across_y_.empty() && across_y_before_.empty() && next_ == plane_.size() &&
                      next_below_ == plane_below_.size();
    if (!none) collect_found(j, row, cells);
  }

 private:
  void collect_found(std::uint32_t j, std::uint32_t row, std::vector<JoinedCell>& cells);

  struct Face {
    std::uint32_t row;
    std::uint16_t cell;
  };
  struct CellFace {
    std::uint16_t cell;
    std::uint8_t face;
    friend auto operator<=>(const CellFace&, const CellFace&) = default;
  };

  std::vector<Face> plane_, plane_below_;  // across z, rows ascending
  std::size_t next_below_ = 0, next_ = 0;
  std::vector<CellFace> row_;  // of the current row of cells
  std::vector<std::uint16_t> across_y_, across_y_before_;
};

}  // namespace meso::implicit
