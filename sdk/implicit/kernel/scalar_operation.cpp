// SPDX-License-Identifier: Apache-2.0
#include "scalar_operation.hpp"

#include <cassert>

#include "meso/expr/operations.hpp"

namespace meso::implicit {

using expr::Op;

double apply_operation(Op op, std::span<const double> v) {
  switch (op) {
    case Op::negate:
      return expr::apply<Op::negate>(v[0]);
    case Op::logical_not:
      return expr::apply<Op::logical_not>(v[0]);
    case Op::floor:
      return expr::apply<Op::floor>(v[0]);
    case Op::ceil:
      return expr::apply<Op::ceil>(v[0]);
    case Op::round:
      return expr::apply<Op::round>(v[0]);
    case Op::abs:
      return expr::apply<Op::abs>(v[0]);
    case Op::sign:
      return expr::apply<Op::sign>(v[0]);
    case Op::sqrt:
      return expr::apply<Op::sqrt>(v[0]);
    case Op::exp:
      return expr::apply<Op::exp>(v[0]);
    case Op::log:
      return expr::apply<Op::log>(v[0]);
    case Op::sin:
      return expr::apply<Op::sin>(v[0]);
    case Op::cos:
      return expr::apply<Op::cos>(v[0]);
    case Op::tan:
      return expr::apply<Op::tan>(v[0]);
    case Op::asin:
      return expr::apply<Op::asin>(v[0]);
    case Op::acos:
      return expr::apply<Op::acos>(v[0]);
    case Op::atan:
      return expr::apply<Op::atan>(v[0]);
    case Op::add:
      return expr::apply<Op::add>(v[0], v[1]);
    case Op::subtract:
      return expr::apply<Op::subtract>(v[0], v[1]);
    case Op::multiply:
      return expr::apply<Op::multiply>(v[0], v[1]);
    case Op::divide:
      return expr::apply<Op::divide>(v[0], v[1]);
    case Op::power:
      return expr::apply<Op::power>(v[0], v[1]);
    case Op::less:
      return expr::apply<Op::less>(v[0], v[1]);
    case Op::less_equal:
      return expr::apply<Op::less_equal>(v[0], v[1]);
    case Op::greater:
      return expr::apply<Op::greater>(v[0], v[1]);
    case Op::greater_equal:
      return expr::apply<Op::greater_equal>(v[0], v[1]);
    case Op::equal:
      return expr::apply<Op::equal>(v[0], v[1]);
    case Op::not_equal:
      return expr::apply<Op::not_equal>(v[0], v[1]);
    case Op::mod:
      return expr::apply<Op::mod>(v[0], v[1]);
    case Op::atan2:
      return expr::apply<Op::atan2>(v[0], v[1]);
    case Op::hypot:
      return expr::apply<Op::hypot>(v[0], v[1]);
    case Op::min:
      return expr::apply<Op::min>(v[0], v[1]);
    case Op::max:
      return expr::apply<Op::max>(v[0], v[1]);
    case Op::clamp:
      return expr::apply<Op::clamp>(v[0], v[1], v[2]);
    case Op::hash:
      return expr::apply_hash(v);
    case Op::logical_and:
      return v[0] != 0 && v[1] != 0 ? 1 : 0;
    case Op::logical_or:
      return v[0] != 0 || v[1] != 0 ? 1 : 0;
    case Op::select:
      return v[0] != 0 ? v[1] : v[2];
    default:
      break;
  }
  assert(!"an operation with operands");
  return 0;
}

}  // namespace meso::implicit
