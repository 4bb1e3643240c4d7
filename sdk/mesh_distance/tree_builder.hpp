// SPDX-License-Identifier: Apache-2.0
#pragma once
// How a TriangleTree is built: neighbours in the order become leaves of up to four triangles; the leaves are parted by
// the surface area heuristic in 16 bins (Wald, On fast construction of SAH-based bounding volume hierarchies, 2007).

#include "triangle_tree.hpp"

namespace meso::implicit {

class TreeBuilder {
 public:
  /// Levels beyond half of this part their leaves in equal halves.
  static constexpr std::size_t max_depth = 96;

  TreeBuilder(std::span<const Triangle> triangles, Vec3 middle, double unit, StopPoll& stop)
      : triangles_(triangles), middle_(middle), unit_(unit), stop_(stop) {}
  [[nodiscard]] std::vector<TriangleTree::Node> build();

 private:
  /// x, y, z, and one lane that means nothing: all at once in a register.
  using Lanes [[gnu::vector_size(16)]] = float;
  struct Box {
    Lanes low{HUGE_VALF, HUGE_VALF, HUGE_VALF, HUGE_VALF}, high{-HUGE_VALF, -HUGE_VALF, -HUGE_VALF, -HUGE_VALF};
    void extend(const Box& b) {
      low = b.low < low ? b.low : low;
      high = b.high > high ? b.high : high;
    }
    [[nodiscard]] float half_area() const {
      const Lanes size = high - low;
      return size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
    }
  };
  struct Leaf {
    Box box;
    std::uint32_t child;
    [[nodiscard]] Lanes middle2() const { return box.low + box.high; }
  };
  using Range = std::span<Leaf>;

  [[nodiscard]] Box box_of(const Triangle& t) const;
  void make_leaves();
  void make_leaves(std::uint32_t first, std::uint32_t last, std::vector<Leaf>& out) const;
  [[nodiscard]] static Box box_of(Range leaves);
  void set_planes(TriangleTree::Node& node, std::size_t slot) const;
  [[nodiscard]] static std::size_t part(Range leaves, std::size_t depth);
  void build_node(Range leaves, std::size_t number, std::size_t depth);
  [[nodiscard]] std::uint32_t move_node(std::uint32_t number, std::vector<TriangleTree::Node>& out) const;

  std::span<const Triangle> triangles_;
  Vec3 middle_;
  double unit_;
  StopPoll& stop_;
  std::vector<Leaf> leaves_;
  std::unique_ptr<TriangleTree::Node[]> nodes_;
};

}  // namespace meso::implicit
