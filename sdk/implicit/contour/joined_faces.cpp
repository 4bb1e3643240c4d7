// SPDX-License-Identifier: Apache-2.0
#include "joined_faces.hpp"

#include <algorithm>

#include "bits.hpp"

namespace meso::implicit {
namespace {

// p and q hold opposite corners each.
bool joins(double p0, double p1, double q0, double q1, bool p_inside) {
  return p_inside ? p0 * p1 > q0 * q1 : q0 * q1 > p0 * p1;
}

bool bit(const std::uint64_t* words, std::size_t i) { return (words[i / 64] >> i % 64 & 1U) != 0; }

// A face between nodes i - 1 and i of two rows: `near` and `far`.
bool joins_between(const SampleRow& near, const SampleRow& far, std::size_t i) {
  const auto n = static_cast<std::ptrdiff_t>(i);
  return joins(near.values[n - 1], far.values[n], near.values[n], far.values[n - 1], bit(far.inside, i));
}

// All four sides of the face between nodes i - 1 and i of two rows are crossed.
std::uint64_t ambiguous(const SampleRow& near, const SampleRow& far, std::size_t w) {
  const std::uint64_t n = near.inside[w], f = far.inside[w], nl = moved_up(near.inside, w),
                      fl = moved_up(far.inside, w);
  return (n ^ nl) & (f ^ fl) & (n ^ f);
}

}  // namespace

void JoinedFaces::begin_brick() { plane_.clear(); }

void JoinedFaces::begin_plane() {
  std::swap(plane_, plane_below_);
  plane_.clear();
  next_ = next_below_ = 0;
  across_y_.clear();
  across_y_before_.clear();
}

void JoinedFaces::find_across_z(const CellRows& rows, std::uint32_t j, std::size_t w) {
  for_each_bit(ambiguous(rows.c, rows.d, w), w, [&](std::size_t i) {
    if (joins_between(rows.c, rows.d, i)) plane_.push_back({j, static_cast<std::uint16_t>(i)});
  });
}

void JoinedFaces::find_across_x_and_y(const CellRows& rows, std::size_t w) {
  for_each_bit(ambiguous(rows.b, rows.d, w), w, [&](std::size_t i) {
    if (joins_between(rows.b, rows.d, i)) across_y_.push_back(static_cast<std::uint16_t>(i));
  });
  const std::uint64_t a = rows.a.inside[w], b = rows.b.inside[w], c = rows.c.inside[w], d = rows.d.inside[w];
  for_each_bit((a ^ b) & (c ^ d) & (a ^ c), w, [&](std::size_t i) {
    if (!joins(rows.a.values[i], rows.d.values[i], rows.b.values[i], rows.c.values[i], bit(rows.d.inside, i))) return;
    row_.push_back({static_cast<std::uint16_t>(i), 1});
    row_.push_back({static_cast<std::uint16_t>(i + 1), 0});
  });
}

void JoinedFaces::collect_found(std::uint32_t j, std::uint32_t row, std::vector<JoinedCell>& cells) {
  for (; next_below_ < plane_below_.size() && plane_below_[next_below_].row == j; ++next_below_)
    row_.push_back({plane_below_[next_below_].cell, 4});
  for (; next_ < plane_.size(); ++next_) row_.push_back({plane_[next_].cell, 5});
  for (const std::uint16_t cell : across_y_before_) row_.push_back({cell, 2});
  for (const std::uint16_t cell : across_y_) row_.push_back({cell, 3});
  std::swap(across_y_, across_y_before_);
  across_y_.clear();
  if (row_.empty()) return;
  std::sort(row_.begin(), row_.end());
  for (std::size_t i = 0; i < row_.size();) {
    JoinedCell cell{row, row_[i].cell, 0};
    for (; i < row_.size() && row_[i].cell == cell.cell; ++i)
      cell.joined |= static_cast<std::uint8_t>(1U << row_[i].face);
    cells.push_back(cell);
  }
}

}  // namespace meso::implicit
