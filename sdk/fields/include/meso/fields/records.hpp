// SPDX-License-Identifier: Apache-2.0
#pragma once
// Rows of doubles, in memory or in a file that is mapped and never copied.
//
//   const Records records = Records::of({0, 1, 2, 3, 4, 5}, 3);   // two rows of three
//   records(1, 2);                                                 // 5
//   const auto file = ResourceBytes::open("values.raw", error);
//   auto mapped = Records::map(file, {.offset = 16, .rows = 10'000'000, .columns = 4});   // nothing if it is too short
//
// Cheap to copy (copies share the numbers), immutable, safe to share between threads. A mapped file must not change
// while it is in use. Numbers are little-endian IEEE doubles, as this machine's.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <vector>

#include "meso/resource/resource.hpp"

namespace meso::fields {

static_assert(std::endian::native == std::endian::little, "records are stored little-endian");

/// Where the rows stand in a file. A stride of 0 means dense rows.
struct RecordLayout {
  std::uint64_t offset = 0, stride = 0;  ///< bytes
  std::size_t rows = 0, columns = 0;
};

class Records {
 public:
  Records() = default;
  /// REQUIRES: columns > 0 divides the number of values.
  [[nodiscard]] static Records of(std::vector<double> values, std::size_t columns);
  /// Dense rows that `owner` keeps alive.
  [[nodiscard]] static Records within(std::shared_ptr<const void> owner, const std::byte* first, std::size_t rows,
                                      std::size_t columns);
  /// Nothing if the file is shorter than the layout. REQUIRES: rows and columns > 0.
  [[nodiscard]] static std::optional<Records> map(std::shared_ptr<const ResourceBytes> file,
                                                  const RecordLayout& layout);
  /// Bytes that a file of this layout has at least; nothing if no file can be so long.
  [[nodiscard]] static std::optional<std::uint64_t> bytes_needed(const RecordLayout& layout);

  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] double operator()(std::size_t row, std::size_t column) const {
    double value = 0;
    std::memcpy(&value, data_ + row * stride_ + column * sizeof value, sizeof value);
    return value;
  }

 private:
  std::shared_ptr<const void> owner_;
  const std::byte* data_ = nullptr;
  std::size_t stride_ = 0, rows_ = 0, columns_ = 0;
};

}  // namespace meso::fields
