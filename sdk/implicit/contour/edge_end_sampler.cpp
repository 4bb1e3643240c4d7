// SPDX-License-Identifier: Apache-2.0
#include "edge_end_sampler.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>

#include "bits.hpp"

namespace meso::implicit {
namespace {

constexpr std::size_t batch = 4096;             // some milliseconds of a dear field
constexpr std::int32_t rows_between_looks = 8;  // likewise, at the dearest

// Signs decide which edges are crossed. A value beside the surface that was computed along another way may contradict
// its sign by rounding: then it is as good as zero.
float with_sign(float value, bool negative) {
  if (std::isnan(value) || (value < 0) == negative) return value;
  return negative ? -FLT_MIN : FLT_MIN;
}

// Rows start at cache lines.
std::size_t words_of_row(std::size_t nx) { return (nx + 511) / 512 * 8; }
std::size_t floats_of_row(std::size_t nx) { return (nx + 63) / 64 * 64; }

}  // namespace

EdgeEndSampler::EdgeEndSampler(const Grid& grid, std::unique_ptr<GridSampler> signs, double exact_within,
                               std::function<bool()> go_on)
    : grid_(grid),
      source_(std::move(signs)),
      exact_within_(static_cast<float>(exact_within)),
      go_on_(std::move(go_on)),
      words_(words_of_row(static_cast<std::size_t>(grid.nodes[0]))),
      stride_(floats_of_row(static_cast<std::size_t>(grid.nodes[0]))),
      ends_(words_) {
  const auto rows = static_cast<std::size_t>(grid.nodes[1]);
  for (Words& plane : signs_) plane.resize(rows * words_);
  for (Floats& plane : values_) plane.resize(rows * stride_);
}

std::uint64_t EdgeEndSampler::bytes(std::uint64_t nx, std::uint64_t ny) {
  return ny * (3 * words_of_row(nx) * sizeof(std::uint64_t) + 2 * floats_of_row(nx) * sizeof(float));
}

std::uint64_t EdgeEndSampler::grown_bytes() const {
  return points_.capacity() * sizeof(Vec3) + missing_.capacity() * sizeof(Missing) +
         computed_.capacity() * sizeof(double);
}

void EdgeEndSampler::begin_slab(std::int32_t first, std::int32_t last) {
  source_->begin_slab(first, last);
  first_ = first;
  last_ = last;
  in_plane_ = -1;
  sample_plane(first);
}

void EdgeEndSampler::sample_plane(std::int32_t k) {
  for (std::int32_t j = 0; j < grid_.nodes[1]; ++j) {
    if (j % rows_between_looks == 0 && !go_on_()) return;
    source_->row(j, k, values(j, k), signs(j, k));
  }
}

void EdgeEndSampler::enter_plane(std::int32_t k) {
  in_plane_ = k;
  if (k + 1 < last_) sample_plane(k + 1);
  for (std::int32_t j = 0; j < grid_.nodes[1]; ++j) {
    mark_ends(j, k);
    look_at_ends(j, k);
    if (points_.size() >= batch) ask_for_missing();
  }
  ask_for_missing();
}

void EdgeEndSampler::mark_ends(std::int32_t j, std::int32_t k) {
  const std::uint64_t* const row = signs(j, k);
  const auto last_node = static_cast<std::size_t>(grid_.nodes[0]) - 1;
  for (std::size_t w = 0; w < words_; ++w) {
    std::uint64_t crossed = row[w] ^ (row[w] << 1 | (w > 0 ? row[w - 1] >> 63 : row[0] & 1U));
    if (w == (last_node + 1) / 64) crossed &= ~(std::uint64_t{1} << (last_node + 1) % 64);  // the edge out of the box
    ends_[w] = crossed | crossed >> 1;
    if (w > 0) ends_[w - 1] |= crossed << 63;
  }
  const auto differ = [&](std::int32_t dj, std::int32_t dk) {
    if (j + dj < 0 || j + dj >= grid_.nodes[1] || k + dk < first_ || k + dk >= last_) return;
    const std::uint64_t* const other = signs(j + dj, k + dk);
    for (std::size_t w = 0; w < words_; ++w) ends_[w] |= row[w] ^ other[w];
  };
  differ(-1, 0), differ(1, 0), differ(0, -1), differ(0, 1);
}

/// What the row told exactly stays; the other ends are put on the list.
void EdgeEndSampler::look_at_ends(std::int32_t j, std::int32_t k) {
  const std::uint64_t* const row = signs(j, k);
  float* const values = this->values(j, k);
  const float within = exact_within_;
  for (std::size_t w = 0; w < words_; ++w) {
    std::uint64_t missing = 0;
    for_each_bit(ends_[w], w, [&](std::size_t i) {
      const std::uint64_t negative = row[w] >> i % 64 & 1;
      const bool is_exact = within > 0 && std::abs(values[i]) <= within;
      missing |= std::uint64_t{!is_exact} << i % 64;
      values[i] = with_sign(values[i], negative != 0);
    });
    for_each_bit(missing, w, [&](std::size_t i) {
      points_.push_back(grid_.node(static_cast<std::int32_t>(i), j, k));
      missing_.push_back({values + i, (row[w] >> i % 64 & 1) != 0});
    });
  }
}

void EdgeEndSampler::ask_for_missing() {
  computed_.resize(points_.size());
  for (std::size_t i = 0; i < points_.size() && go_on_(); i += batch) {
    const std::size_t count = std::min(batch, points_.size() - i);
    source_->values_at(std::span(points_).subspan(i, count), computed_.data() + i);
  }
  for (std::size_t i = 0; i < computed_.size(); ++i)
    *missing_[i].value = with_sign(static_cast<float>(computed_[i]), missing_[i].negative);
  points_.clear();
  missing_.clear();
}

void EdgeEndSampler::row(std::int32_t j, std::int32_t k, float* values, std::uint64_t* inside) {
  if (k != in_plane_) enter_plane(k);
  const auto nodes = static_cast<std::size_t>(grid_.nodes[0]);
  std::copy_n(signs(j, k), (nodes + 63) / 64, inside);
  std::copy_n(this->values(j, k), nodes, values);
}

}  // namespace meso::implicit
