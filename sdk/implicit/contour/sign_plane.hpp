// SPDX-License-Identifier: Apache-2.0
#pragma once
// A plane of signs, read back from its record, and where the numbers of its rows' vertices begin.

#include <vector>

#include "brick_record.hpp"

namespace meso::implicit {

struct RowNumbers {
  std::uint32_t x = 0, y = 0, z = 0, centre = 0;
  std::uint32_t x_last = 0;  ///< of the last edge along x
};

class SignPlane {
 public:
  explicit SignPlane(const Layout& layout)
      : rows_(layout.ny),
        words_(layout.words),
        stride_(layout.words + 1),
        signs_(stride_ * (rows_ + 2) + 1),
        numbers_(rows_ + 1) {}

  /// Nothing inside.
  void clear() { std::fill(signs_.begin(), signs_.end(), 0); }

  /// Reads a plane's rows 0 ... ny, moving `from` on; its vertices are numbered from `next` on.
  void read(const std::uint16_t*& from, std::uint32_t& next) {
    for (std::size_t j = 0; j <= rows_; ++j) {
      const RowCounts counts = read_row(from, at(static_cast<std::ptrdiff_t>(j)), words_);
      RowNumbers& n = numbers_[j];
      n.x = next;
      n.y = n.x + counts.x;
      n.z = n.y + counts.y;
      n.centre = n.z + counts.z;
      n.x_last = n.y - 1;
      next += counts.total();
    }
  }

  /// Row j = -1 ... ny; the first and the last are outside. at(j)[-1] is 0.
  [[nodiscard]] std::uint64_t* at(std::ptrdiff_t j) {
    return signs_.data() + 1 + static_cast<std::size_t>(j + 1) * stride_;
  }
  [[nodiscard]] const RowNumbers& numbers(std::size_t j) const { return numbers_[j]; }

 private:
  std::size_t rows_, words_, stride_;
  std::vector<std::uint64_t> signs_;
  std::vector<RowNumbers> numbers_;
};

}  // namespace meso::implicit
