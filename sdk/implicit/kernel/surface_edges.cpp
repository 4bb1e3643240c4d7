// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/surface_edges.hpp"

#include <algorithm>
#include <vector>

#include "meso/implicit/flat_term.hpp"
#include "meso/implicit/interval_arithmetic.hpp"

namespace meso::implicit {
namespace {

using expr::Op;

bool is_smooth(Op op) {
  switch (op) {
    case Op::number:
    case Op::negate:
    case Op::add:
    case Op::subtract:
    case Op::multiply:
    case Op::divide:
    case Op::power:
    case Op::exp:
    case Op::log:
    case Op::sin:
    case Op::cos:
    case Op::tan:
    case Op::asin:
    case Op::acos:
    case Op::atan:
      return true;
    default:
      return false;
  }
}

/// The steps of a term, and which of them turn sharply somewhere in a box.
class Turns {
 public:
  Turns(const Term& term, const Box3& box) : flat_(term), intervals_(flat_.intervals(box)) {
    const Vec3 size = box.max - box.min;
    rounding_ = 1e-9 * std::max({size.x, size.y, size.z});
    for (std::size_t i = 0; i < flat_.steps().size(); ++i) turns_.push_back(turns(i));
  }

  /// On the surface alone: by operations at the root, down to where it does not matter what the value is.
  [[nodiscard]] bool on_surface() const {
    std::size_t at = flat_.steps().size() - 1;
    while (turns_[at]) {
      const FlatTerm::Step& step = flat_.steps()[at];
      const auto operands = flat_.operands(step);
      if (step.op == Op::negate) {
        at = operands[0];
      } else if (step.op == Op::max && intervals_[operands[0]].hi <= rounding_) {
        at = operands[1];  // the other only ends at the box's sides
      } else if (step.op == Op::max && intervals_[operands[1]].hi <= rounding_) {
        at = operands[0];
      } else if ((step.op == Op::subtract || step.op == Op::add) && is_number(operands[1]) &&
                 number(operands[1]) != 0 && flat_.steps()[operands[0]].op == Op::abs) {
        return turns_[flat_.operands(flat_.steps()[operands[0]])[0]];  // abs() turns where the field is that number
      } else {
        return true;
      }
    }
    return false;
  }

 private:
  [[nodiscard]] bool is_number(std::size_t i) const { return flat_.steps()[i].op == Op::number; }
  [[nodiscard]] double number(std::size_t i) const { return flat_.steps()[i].node->number; }

  [[nodiscard]] bool turns(std::size_t i) const {
    const FlatTerm::Step& step = flat_.steps()[i];
    const auto operands = flat_.operands(step);
    if (step.op == Op::name) return step.node->axis == TermNode::external_axis;
    if (step.op == Op::min || step.op == Op::max) {
      const std::array<Interval, 2> both{intervals_[operands[0]], intervals_[operands[1]]};
      const Choice choice = choice_of(step.op, both);
      if (choice != Choice::none) return turns_[operands[choice == Choice::first ? 0 : 1]];
    }
    const bool away_from_zero =
        (step.op == Op::abs || step.op == Op::sqrt) &&
        (intervals_[operands[0]].lo > 0 || (step.op == Op::abs && intervals_[operands[0]].hi < 0));
    if (!is_smooth(step.op) && !away_from_zero) return true;
    return std::any_of(operands.begin(), operands.end(), [&](std::uint32_t o) { return turns_[o]; });
  }

  FlatTerm flat_;
  std::vector<Interval> intervals_;
  double rounding_ = 0;
  std::vector<bool> turns_;
};

}  // namespace

bool may_have_edges(const Term& term, const Box3& box) { return Turns(term, box).on_surface(); }

}  // namespace meso::implicit
