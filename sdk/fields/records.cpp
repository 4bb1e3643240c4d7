// SPDX-License-Identifier: Apache-2.0
#include "meso/fields/records.hpp"

#include <cassert>

namespace meso::fields {
namespace {

std::uint64_t stride_of(const RecordLayout& layout) {
  return layout.stride == 0 ? layout.columns * sizeof(double) : layout.stride;
}

}  // namespace

Records Records::of(std::vector<double> values, std::size_t columns) {
  assert(columns > 0 && values.size() % columns == 0);
  const auto owner = std::make_shared<const std::vector<double>>(std::move(values));
  return within(owner, reinterpret_cast<const std::byte*>(owner->data()), owner->size() / columns, columns);
}

Records Records::within(std::shared_ptr<const void> owner, const std::byte* first, std::size_t rows,
                        std::size_t columns) {
  Records result;
  result.owner_ = std::move(owner);
  result.data_ = first;
  result.stride_ = columns * sizeof(double);
  result.rows_ = rows;
  result.columns_ = columns;
  return result;
}

std::optional<std::uint64_t> Records::bytes_needed(const RecordLayout& layout) {
  assert(layout.rows > 0 && layout.columns > 0);
  std::uint64_t end = 0, row = 0;
  if (__builtin_mul_overflow(layout.columns, sizeof(double), &row) ||
      __builtin_mul_overflow(stride_of(layout), std::uint64_t{layout.rows} - 1, &end) ||
      __builtin_add_overflow(end, row, &end) || __builtin_add_overflow(end, layout.offset, &end) || end >> 63 != 0)
    return std::nullopt;
  return end;
}

std::optional<Records> Records::map(std::shared_ptr<const ResourceBytes> file, const RecordLayout& layout) {
  const auto needed = bytes_needed(layout);
  if (!needed || *needed > file->view().size()) return std::nullopt;
  Records result;
  result.data_ = reinterpret_cast<const std::byte*>(file->view().data()) + layout.offset;
  result.stride_ = static_cast<std::size_t>(stride_of(layout));
  result.rows_ = layout.rows;
  result.columns_ = layout.columns;
  result.owner_ = std::move(file);
  return result;
}

}  // namespace meso::fields
