// SPDX-License-Identifier: Apache-2.0
#include "edge_end_sampler.hpp"

#include <algorithm>
#include <bit>
#include <cfloat>
#include <cmath>

#include "bits.hpp"

namespace meso::implicit {
namespace {

constexpr std::size_t batch = 4096;  // some milliseconds of a dear field

// Signs decide which edges are crossed. A value beside the surface that was computed along another way may contradict
// its sign by rounding: then it is as good as zero.
float with_sign(float value, bool negative) {
  if (std::isnan(value) || (value < 0) == negative) return value;
  return negative ? -FLT_MIN : FLT_MIN;
}

}  // namespace

EdgeEndSampler::EdgeEndSampler(const Grid& grid, std::unique_ptr<GridSampler> signs, double exact_within,
                               std::function<bool()> go_on)
    : grid_(grid),
      source_(std::move(signs)),
      exact_within_(static_cast<float>(exact_within)),
      go_on_(std::move(go_on)),
      rows_(static_cast<std::size_t>(grid.nodes[1])),
      words_((static_cast<std::size_t>(grid.nodes[0]) + 511) / 512 * 8),
      row_values_(words_ * 64) {}

void EdgeEndSampler::begin_slab(std::int32_t first, std::int32_t last) {
  source_->begin_slab(first, last);
  first_ = first;
  last_ = last;
  const std::size_t rows = static_cast<std::size_t>(last - first) * rows_;
  signs_.assign(rows * words_, 0);
  ends_.assign(rows * words_, 0);
  exact_.clear();
  exact_values_.clear();
  first_exact_.clear();
  for (std::int32_t k = first; k < last; ++k)
    for (std::int32_t j = 0; j < grid_.nodes[1] && go_on_(); ++j) {
      source_->row(j, k, row_values_.data(), at(j, k));
      if (exact_within_ > 0) keep_exact();
    }
  if (!go_on_()) exact_.clear();
  first_value_.clear();
  std::size_t ends = 0;
  for (std::int32_t k = first; k < last; ++k)
    for (std::int32_t j = 0; j < grid_.nodes[1]; ++j) {
      first_value_.push_back(ends);
      ends += mark_ends(j, k);
    }
  values_.resize(ends);
  for (std::int32_t k = first; k < last; ++k)
    for (std::int32_t j = 0; j < grid_.nodes[1]; ++j) take_values(j, k);
  flush();
}

/// Of the row that was just sampled. Where a sampler left a value as it was no edge ends.
void EdgeEndSampler::keep_exact() {
  first_exact_.push_back(exact_values_.size());
  for (std::size_t w = 0; w < words_; ++w) {
    const float* const values = row_values_.data() + 64 * w;
    std::uint64_t near = 0;
    for (std::size_t i = 0; i < 64; ++i) near |= std::uint64_t{std::abs(values[i]) <= exact_within_} << i;
    exact_.push_back(near);
    for_each_bit(near, 0, [&](std::size_t i) { exact_values_.push_back(values[i]); });
  }
}

/// Takes what is known, and puts the other ends on the list.
void EdgeEndSampler::take_values(std::int32_t j, std::int32_t k) {
  const std::size_t row = row_of(j, k);
  std::size_t place = first_value_[row], known = exact_.empty() ? 0 : first_exact_[row];
  for (std::size_t w = 0; w < words_; ++w) {
    const std::uint64_t exact = exact_.empty() ? 0 : exact_[row * words_ + w];
    for_each_bit(ends_[row * words_ + w], w, [&](std::size_t i) {
      const std::uint64_t bit = std::uint64_t{1} << i % 64;
      if ((exact & bit) != 0) {
        values_[place] = exact_values_[known + static_cast<std::size_t>(std::popcount(exact & (bit - 1)))];
      } else {
        points_.push_back(grid_.node(static_cast<std::int32_t>(i), j, k));
        places_.push_back(place);
      }
      ++place;
    });
    known += static_cast<std::size_t>(std::popcount(exact));
  }
  if (points_.size() >= batch) flush();
}

void EdgeEndSampler::flush() {
  computed_.resize(points_.size());
  for (std::size_t i = 0; i < points_.size() && go_on_(); i += batch) {
    const std::size_t count = std::min(batch, points_.size() - i);
    source_->values_at(std::span(points_).subspan(i, count), computed_.data() + i);
  }
  for (std::size_t i = 0; i < computed_.size(); ++i) values_[places_[i]] = static_cast<float>(computed_[i]);
  points_.clear();
  places_.clear();
}

std::uint64_t EdgeEndSampler::bytes() const {
  return (signs_.capacity() + ends_.capacity() + exact_.capacity()) * sizeof(std::uint64_t) +
         (values_.capacity() + exact_values_.capacity()) * sizeof(float) +
         (first_value_.capacity() + first_exact_.capacity()) * sizeof(std::size_t);
}

std::size_t EdgeEndSampler::mark_ends(std::int32_t j, std::int32_t k) {
  const std::uint64_t* const row = at(j, k);
  std::uint64_t* const ends = ends_.data() + (row - signs_.data());
  const auto last_node = static_cast<std::size_t>(grid_.nodes[0]) - 1;
  const auto differ = [&](std::int32_t dj, std::int32_t dk) {
    if (j + dj < 0 || j + dj >= grid_.nodes[1] || k + dk < first_ || k + dk >= last_) return;
    const std::uint64_t* const other = at(j + dj, k + dk);
    for (std::size_t w = 0; w < words_; ++w) ends[w] |= row[w] ^ other[w];
  };
  differ(-1, 0), differ(1, 0), differ(0, -1), differ(0, 1);
  for (std::size_t w = 0; w < words_; ++w) {
    std::uint64_t crossed = row[w] ^ (row[w] << 1 | (w > 0 ? row[w - 1] >> 63 : row[0] & 1U));
    if (w == (last_node + 1) / 64) crossed &= ~(std::uint64_t{1} << (last_node + 1) % 64);  // the edge out of the box
    ends[w] |= crossed | crossed >> 1;
    if (w > 0) ends[w - 1] |= crossed << 63;
  }
  std::size_t count = 0;
  for (std::size_t w = 0; w < words_; ++w) count += static_cast<std::size_t>(std::popcount(ends[w]));
  return count;
}

void EdgeEndSampler::row(std::int32_t j, std::int32_t k, float* values, std::uint64_t* inside) {
  const std::uint64_t* const row = at(j, k);
  std::copy_n(row, (static_cast<std::size_t>(grid_.nodes[0]) + 63) / 64, inside);
  const auto offset = static_cast<std::size_t>(row - signs_.data());
  const float* value = values_.data() + first_value_[offset / words_];
  for (std::size_t w = 0; w < words_; ++w)
    for_each_bit(ends_[offset + w], w, [&](std::size_t i) {
      const bool negative = (row[w] >> (i % 64) & 1) != 0;
      values[i] = with_sign(*value++, negative);
    });
}

}  // namespace meso::implicit
