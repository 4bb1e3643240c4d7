// SPDX-License-Identifier: Apache-2.0
#pragma once
// How often a surface encloses each node of a grid, row by row, as places where that number changes: what is stored
// grows with the surface, not with the nodes.

#include <cstdint>
#include <span>
#include <vector>

#include "meso/base/triangle_stream.hpp"
#include "stop_poll.hpp"

namespace meso::implicit {

/// Coordinates of the nodes along one axis, ascending.
class Ticks {
 public:
  explicit Ticks(std::vector<double> values);
  [[nodiscard]] std::int32_t size() const { return static_cast<std::int32_t>(values_.size()); }
  [[nodiscard]] double operator[](std::int32_t i) const { return values_[static_cast<std::size_t>(i)]; }
  /// The first tick at or after x; size() if there is none.
  [[nodiscard]] std::int32_t at_or_after(double x) const;
  [[nodiscard]] std::int32_t after(double x) const;

 private:
  [[nodiscard]] std::int32_t near(double x) const;
  std::vector<double> values_;
  double per_unit_ = 0;
};

struct GridTicks {
  Ticks x, y, z;
  [[nodiscard]] std::size_t rows() const { return std::size_t(y.size()) * std::size_t(z.size()); }
  [[nodiscard]] std::size_t row(std::int32_t j, std::int32_t k) const {
    return std::size_t(k) * std::size_t(y.size()) + std::size_t(j);
  }
};

class RowSigns {
 public:
  /// From this node on, the number is `winding`.
  struct Change {
    std::int32_t node;
    std::int32_t winding;
  };
  /// A node exactly on the surface.
  struct Touch {
    std::uint64_t row;
    std::int32_t node;
    friend auto operator<=>(const Touch&, const Touch&) = default;
  };

  /// Counts, along every row, the triangles entered and left: exact for a closed surface. Cut short by `stop`, it means
  /// nothing.
  RowSigns(std::span<const Triangle> triangles, const GridTicks& ticks, StopPoll& stop);

  [[nodiscard]] std::span<const Change> changes(std::size_t row) const {
    return std::span(changes_).subspan(start_[row], start_[row + 1] - start_[row]);
  }
  [[nodiscard]] std::span<const Touch> touches(std::size_t row) const;
  [[nodiscard]] std::span<const Touch> touches() const { return touches_; }
  /// Keeps those that are marked. REQUIRES: a mark for each.
  void keep_touches(std::span<const char> marks);
  /// -1: enclosed, 0: on the surface, 1: outside.
  [[nodiscard]] int sign(std::size_t row, std::int32_t node) const;

  /// Other numbers than those counted: `changes` of all rows one after the other, those of row r from start[r] on.
  void replace_changes(std::vector<std::size_t> start, std::vector<Change> changes) {
    start_ = std::move(start);
    changes_ = std::move(changes);
  }

 private:
  std::vector<std::size_t> start_;
  std::vector<Change> changes_;
  std::vector<Touch> touches_;  // sorted
};

}  // namespace meso::implicit
