// SPDX-License-Identifier: Apache-2.0
#pragma once
// Which of very many primitives reach into a ball: by a tree of boxes, or, where they repeat, by counting steps of the
// lattice - then only one period is kept, however many copies there are. Private.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "primitive.hpp"

namespace meso::implicit {

/// Copies at steps * (i, j, k), 0 <= i < count[0] and so on.
struct Repetition {
  Mat3 steps;  ///< columns; independent of each other, also where the count is 1
  std::array<std::int64_t, 3> count{1, 1, 1};
};

class PrimitiveIndex {
 public:
  PrimitiveIndex(std::vector<Primitive> primitives, const std::optional<Repetition>& repetition);

  /// Calls back f(primitive, displacement) for every primitive whose box, displaced, meets the box; perhaps for some
  /// more.
  template <class Function>
  void visit(const Box3& box, Function f) const {
    if (repetition_)
      visit_repeated(box, f);
    else
      visit_tree(box, f);
  }

  /// The same for a lattice that goes on without end, where it is more than one step long: f(primitive, steps). Their
  /// displacement is repetition()->steps * steps. REQUIRES: a repetition.
  template <class Function>
  void visit_endless(const Box3& box, Function f) const {
    visit_steps(box, true, f);
  }

  [[nodiscard]] const std::optional<Repetition>& repetition() const { return repetition_; }
  [[nodiscard]] const std::vector<Primitive>& primitives() const { return primitives_; }
  [[nodiscard]] const Box3& box() const { return box_; }  ///< around all copies
  [[nodiscard]] std::uint64_t bytes() const;

 private:
  static constexpr std::uint32_t leaf_size = 4;
  struct Node {
    Box3 box;
    std::uint32_t first = 0, count = 0;  ///< primitives of a leaf; count 0: children are `first` and first + 1
  };

  template <class Function>
  void visit_tree(const Box3& box, Function f) const {
    std::array<std::uint32_t, 64> open{};
    std::size_t count = nodes_.empty() ? 0 : 1;
    while (count > 0) {
      const Node& node = nodes_[open[--count]];
      if (!node.box.intersects(box)) continue;
      if (node.count == 0) {
        open[count++] = node.first + 1;
        open[count++] = node.first;
        continue;
      }
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
        if (primitives_[i].box.intersects(box)) f(primitives_[i], Vec3{});
    }
  }

  template <class Function>
  void visit_repeated(const Box3& box, Function f) const {
    visit_steps(box, false, [&](const Primitive& primitive, const std::array<std::int64_t, 3>& s) {
      f(primitive,
        repetition_->steps * Vec3{static_cast<double>(s[0]), static_cast<double>(s[1]), static_cast<double>(s[2])});
    });
  }

  template <class Function>
  void visit_steps(const Box3& box, bool endless, Function f) const {
    const Vec3 half = 0.5 * (box.max - box.min), middle = box.min + half;
    const Vec3 reach = absolute_inverse_ * half, at = inverse_ * middle;
    for (std::size_t p = 0; p < primitives_.size(); ++p) {
      // The copies whose boxes' middles are near enough, in steps.
      std::array<std::int64_t, 3> first{}, last{}, s{};
      bool none = false;
      for (std::size_t a = 0; a < 3; ++a) {
        const double far = reach[a] + reaches_[p][a], from = at[a] - places_[p][a];
        const bool one = repetition_->count[a] == 1, clamps = !endless || one;
        first[a] = one ? 0 : steps_of(std::ceil(from - far), a, clamps);
        last[a] = one ? 0 : steps_of(std::floor(from + far), a, clamps);
        none = none || (clamps && (from + far < 0 || from - far > static_cast<double>(repetition_->count[a] - 1)));
      }
      if (none) continue;
      for (s[0] = first[0]; s[0] <= last[0]; ++s[0])
        for (s[1] = first[1]; s[1] <= last[1]; ++s[1])
          for (s[2] = first[2]; s[2] <= last[2]; ++s[2]) f(primitives_[p], s);
    }
  }
  [[nodiscard]] std::int64_t steps_of(double steps, std::size_t axis, bool clamps) const {
    if (clamps) steps = std::fmin(std::fmax(steps, 0), static_cast<double>(repetition_->count[axis] - 1));
    return static_cast<std::int64_t>(steps);
  }

  void build(std::uint32_t node, std::uint32_t first, std::uint32_t last);

  std::vector<Primitive> primitives_;
  std::optional<Repetition> repetition_;
  Box3 box_;
  std::vector<Node> nodes_;
  Mat3 inverse_, absolute_inverse_;     ///< of the steps
  std::vector<Vec3> places_, reaches_;  ///< of a primitive's box, in steps
};

}  // namespace meso::implicit
