// SPDX-License-Identifier: Apache-2.0
// In a document cells have levels, and moves and joints stand outside. A level of a solid that was moved or bent is a
// move or a bend of the level; an offset of a union is the union of offsets, because the least of f - d and g - d is
// the least of f and g, less d. All of these are the same functions, to the last bit.

#include "document_maker.hpp"

namespace meso::sdf {
namespace {

bool is_rigid(Verb verb) { return is_move(verb) && verb != Verb::scale; }
bool is_joint(Verb verb) { return verb == Verb::union_of || verb == Verb::intersection || verb == Verb::difference; }
bool moves_or_bends(Verb verb) { return is_rigid(verb) || is_bend(verb); }

class LevelsFirst {
 public:
  explicit LevelsFirst(std::deque<Instruction>& made_up) : made_up_(made_up) {}

  SolidTree of(const SolidTree& tree) {
    std::vector<Index> number;
    for (const SolidTree::Node& node : tree.nodes) {
      std::vector<Index> below;
      for (const Index part : node.of) below.push_back(number[part]);
      const Instruction& word = *node.made_by;
      const bool is_number = is_level(word.verb) && word.text.empty() && word.verb != Verb::density;
      number.push_back(is_number ? level(word, below[0]) : add(&word, std::move(below)));
    }
    return needed(number.back());
  }

 private:
  Index add(const Instruction* word, std::vector<Index> of) {
    result_.nodes.push_back({word, std::move(of)});
    return static_cast<Index>(result_.nodes.size() - 1);
  }
  [[nodiscard]] Verb verb(Index node) const { return result_.nodes[node].made_by->verb; }
  [[nodiscard]] Index below(Index node, std::size_t which = 0) const { return result_.nodes[node].of[which]; }

  // Moves and bends are taken off and put on again outside.
  Index level(const Instruction& word, Index of) {
    std::vector<const Instruction*> moves;
    while (moves_or_bends(verb(of))) {
      moves.push_back(result_.nodes[of].made_by);
      of = below(of);
    }
    Index made = 0;
    if (verb(of) == Verb::complement && word.verb != Verb::complement)
      made = level_of_complement(word, of);
    else if (!is_joint(verb(of)) || word.verb == Verb::complement)
      made = add(&word, {of});
    else if (word.verb == Verb::offset)
      made = offset(word, of, word.numbers[0]);
    else if (word.verb == Verb::shell)
      made = wall(word, of, -word.numbers[0] / 2, word.numbers[0] / 2);
    else
      made = wall(word, of, word.numbers[0], word.numbers[1]);
    for (std::size_t i = moves.size(); i-- > 0;) made = add(moves[i], {made});
    return made;
  }

  // Its function is the negative: a wall about the surface is the same, other levels change their signs.
  Index level_of_complement(const Instruction& word, Index of) {
    const Index inside = below(of);
    if (word.verb == Verb::shell) return level(word, inside);
    if (word.verb == Verb::offset)
      return add(result_.nodes[of].made_by, {level(*made_up(word, Verb::offset, -word.numbers[0]), inside)});
    return level(*made_up(word, word.verb, -word.numbers[1], -word.numbers[0]), inside);
  }

  // Between two levels: what is within the upper one, without what is within the lower one.
  Index wall(const Instruction& word, Index of, double lower, double upper) {
    const Index outer = offset(word, of, upper), inner = offset(word, of, lower);
    return add(made_up(word, Verb::difference, 0), {outer, inner});
  }

  Index offset(const Instruction& word, Index of, double distance) {
    const Instruction* const here = result_.nodes[of].made_by;
    if (moves_or_bends(here->verb)) {
      const Index inner = offset(word, below(of), distance);
      return add(here, {inner});
    }
    if (here->verb == Verb::complement) {
      const Index inside = offset(word, below(of), -distance);
      return add(here, {inside});
    }
    if (!is_joint(here->verb)) return add(made_up(word, Verb::offset, distance), {of});
    const Index left = offset(word, below(of), distance);
    const Index right = offset(word, below(of, 1), here->verb == Verb::difference ? -distance : distance);
    return add(here, {left, right});
  }

  // It stands where the word stands that it is made for.
  const Instruction* made_up(const Instruction& word, Verb verb, double number, double other = 0) {
    made_up_.push_back({.verb = verb, .numbers = {number, other}, .word = word.word, .depth = word.depth});
    return &made_up_.back();
  }

  // The tree without what only joints had that were made anew.
  [[nodiscard]] SolidTree needed(Index last) const {
    std::vector<char> is_needed(result_.nodes.size(), 0);
    is_needed[last] = 1;
    for (Index i = last + 1; i-- > 0;)
      if (is_needed[i] != 0)
        for (const Index part : result_.nodes[i].of) is_needed[part] = 1;
    SolidTree tree;
    std::vector<Index> number(result_.nodes.size(), 0);
    for (Index i = 0; i <= last; ++i) {
      if (is_needed[i] == 0) continue;
      number[i] = static_cast<Index>(tree.nodes.size());
      tree.nodes.push_back(result_.nodes[i]);
      for (Index& part : tree.nodes.back().of) part = number[part];
    }
    return tree;
  }

  std::deque<Instruction>& made_up_;
  SolidTree result_;
};

}  // namespace

SolidTree levels_first(const SolidTree& tree, std::deque<Instruction>& made_up) {
  return LevelsFirst(made_up).of(tree);
}

}  // namespace meso::sdf
