// SPDX-License-Identifier: Apache-2.0
#pragma once
// Zeroed memory for rows, aligned as vector loads want it.

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>

namespace meso::implicit {

class AlignedArray {
 public:
  explicit AlignedArray(std::size_t size = 0)
      : data_(static_cast<double*>(::operator new(size * sizeof(double), alignment))) {
    std::fill_n(data_.get(), size, 0.0);
  }
  [[nodiscard]] double* data() const { return data_.get(); }

 private:
  static constexpr std::align_val_t alignment{64};
  struct Free {
    void operator()(double* p) const { ::operator delete(p, alignment); }
  };
  std::unique_ptr<double[], Free> data_;
};

/// Rows are this long in memory.
[[nodiscard]] inline std::size_t padded(std::size_t n) { return (n + 63) / 64 * 64; }

}  // namespace meso::implicit
