// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a program makes of what: its words without the stack. dup, swap, drop, over, def and recall leave no trace.
//
//   const SolidTree tree = solid_tree(program);     // of `ball dup shell 0.2 union`
//   tree.nodes.back()                               // union, of nodes 0 (ball) and 1 (shell, of node 0)
//
// Linear in the number of words. Pointers are into the program. Thread rule: pure.

#include <cstdint>
#include <vector>

#include "meso/sdf/program.hpp"

namespace meso::sdf {

struct SolidTree {
  struct Node {
    const Instruction* made_by = nullptr;
    std::vector<std::uint32_t> of{};  ///< earlier nodes, the lowest of the stack first
  };
  /// Operands before what is made of them; the last one is the solid that is left. Each is needed by it.
  std::vector<Node> nodes;
};

[[nodiscard]] SolidTree solid_tree(const Program& program);

}  // namespace meso::sdf
