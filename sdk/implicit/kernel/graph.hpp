// SPDX-License-Identifier: Apache-2.0
#pragma once
// A term as a graph in which equal subexpressions are one node: what the planner rewrites and the programs are made of.
// Nodes are numbered in the order of their making, operands before what uses them, so the numbers order everything
// that needs an order, and the same term gives the same graph on every machine.

#include <cstdint>
#include <initializer_list>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "meso/implicit/term.hpp"

namespace meso::implicit {

/// Bits: 1 depends on x, 2 on y, 4 on z.
using Axes = std::uint8_t;
inline constexpr Axes x_axis = 1, y_axis = 2, z_axis = 4, all_axes = 7;

/// s0 + a1 s1 + a2 s2 + ..., added from the left; operands s0, a1, s1, a2, s2, ... Made by the planner only.
inline constexpr expr::Op sum_of_products = static_cast<expr::Op>(static_cast<int>(expr::Op::or_skip) + 1);
inline constexpr std::size_t op_count = static_cast<std::size_t>(sum_of_products) + 1;

struct ExternalLeaf {
  std::shared_ptr<const ExternalField> field;
  Affine field_from_world;
};

class Graph {
 public:
  using Id = std::uint32_t;
  struct Node {
    expr::Op op{};
    Axes axes = 0;
    std::uint32_t leaf = 0;  ///< Op::name: 0, 1, 2 for x, y, z; 3 + k for externals()[k]
    std::uint32_t first_operand = 0;
    std::uint32_t operands = 0;
    double number = 0;  ///< Op::number
  };

  Id number(double value);
  Id coordinate(std::uint32_t axis);
  /// Simplifies only where no bit of a result changes, except that small whole powers become products.
  Id apply(expr::Op op, std::span<const Id> operands);
  Id apply(expr::Op op, std::initializer_list<Id> operands) { return apply(op, std::span(operands)); }
  Id from_term(const Term& term);

  [[nodiscard]] const Node& operator[](Id id) const { return nodes_[id]; }
  [[nodiscard]] std::span<const Id> operands(Id id) const {
    return {operands_.data() + nodes_[id].first_operand, nodes_[id].operands};
  }
  [[nodiscard]] std::size_t size() const { return nodes_.size(); }
  [[nodiscard]] const std::vector<ExternalLeaf>& externals() const { return externals_; }
  [[nodiscard]] bool is_number(Id id) const { return nodes_[id].op == expr::Op::number; }
  [[nodiscard]] bool is_external(Id id) const { return nodes_[id].op == expr::Op::name && nodes_[id].leaf >= 3; }
  /// Nodes that `root` needs, itself last, operands before what uses them.
  [[nodiscard]] std::vector<Id> reachable(Id root) const;

 private:
  struct Key {
    expr::Op op;
    std::uint64_t payload;  ///< bits of the number, or the leaf
    std::vector<Id> operands;
    auto operator<=>(const Key&) const = default;
  };
  Id intern(Key key, Node node);
  Id power(Id base, double exponent);
  Id external(const TermNode& leaf);

  std::vector<Node> nodes_;
  std::vector<Id> operands_;
  std::map<Key, Id> known_;
  std::vector<ExternalLeaf> externals_;
};

}  // namespace meso::implicit
