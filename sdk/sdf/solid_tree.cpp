// SPDX-License-Identifier: Apache-2.0
#include "meso/sdf/solid_tree.hpp"

#include <cassert>
#include <map>

namespace meso::sdf {
namespace {

using Node = SolidTree::Node;
using Stack = std::vector<std::uint32_t>;

/// Whether the word only moves solids on the stack, which it then did.
bool arrange(const Instruction& word, Stack& stack, std::map<std::string, std::uint32_t>& named) {
  const std::size_t n = stack.size();
  switch (word.verb) {
    case Verb::dup:
      stack.push_back(stack[n - 1]);
      return true;
    case Verb::over:
      stack.push_back(stack[n - 2]);
      return true;
    case Verb::swap:
      std::swap(stack[n - 1], stack[n - 2]);
      return true;
    case Verb::drop:
      stack.pop_back();
      return true;
    case Verb::def:
      named[word.text] = stack[n - 1];
      stack.pop_back();
      return true;
    case Verb::recall:
      stack.push_back(named.at(word.text));  // parse_program() looked
      return true;
    default:
      return false;
  }
}

/// Those that `root` is made of, and it.
SolidTree needed(std::vector<Node> all, std::uint32_t root) {
  std::vector<bool> is_needed(all.size());
  is_needed[root] = true;
  for (std::uint32_t i = root + 1; i-- > 0;)
    if (is_needed[i])
      for (const std::uint32_t part : all[i].of) is_needed[part] = true;
  std::vector<std::uint32_t> number(all.size());
  SolidTree tree;
  for (std::uint32_t i = 0; i <= root; ++i) {
    if (!is_needed[i]) continue;
    for (std::uint32_t& part : all[i].of) part = number[part];
    number[i] = static_cast<std::uint32_t>(tree.nodes.size());
    tree.nodes.push_back(std::move(all[i]));
  }
  return tree;
}

}  // namespace

SolidTree solid_tree(const Program& program) {
  std::vector<Node> all;
  Stack stack;
  std::map<std::string, std::uint32_t> named;
  for (const Instruction& word : program.instructions) {
    if (arrange(word, stack, named)) continue;
    const std::size_t takes = solids_taken(word.verb);
    Node node{&word, {stack.end() - static_cast<std::ptrdiff_t>(takes), stack.end()}};
    stack.resize(stack.size() - takes);
    stack.push_back(static_cast<std::uint32_t>(all.size()));
    all.push_back(std::move(node));
  }
  assert(stack.size() == 1);  // parse_program() counted
  return needed(std::move(all), stack.back());
}

}  // namespace meso::sdf
