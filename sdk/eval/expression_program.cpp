// SPDX-License-Identifier: Apache-2.0
#include "expression_program.hpp"

#include <muParser.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "meso/expr/operations.hpp"

namespace meso::eval {
namespace {

using expr::Node;
using expr::Op;

/// What an operation needs to report that it has no value: its node, and where the first such node is remembered.
struct Site {
  const Node* node;
  const Node** failed;
};

double watched(void* site, double value) {
  if (!std::isfinite(value)) {
    const Site& s = *static_cast<Site*>(site);
    if (*s.failed == nullptr) *s.failed = s.node;
  }
  return value;
}

template <Op op>
double unary(void* site, double x) {
  return watched(site, expr::apply<op>(x));
}
template <Op op>
double binary(void* site, double x, double y) {
  return watched(site, expr::apply<op>(x, y));
}
double clamp(void* site, double x, double y, double z) { return watched(site, expr::apply<Op::clamp>(x, y, z)); }
double hash(void* site, const double* arguments, int count) {
  return watched(site, expr::apply_hash({arguments, static_cast<std::size_t>(count)}));
}

/// Nothing of muParser's own: it starts with functions, constants and operators that differ from ours.
mu::Parser empty_parser() {
  mu::Parser parser;
  parser.ClearFun();
  parser.ClearConst();
  parser.ClearOprt();
  parser.ClearInfixOprt();
  parser.ClearPostfixOprt();
  parser.ClearVar();
  parser.EnableBuiltInOprt(false);  // leaves parentheses, commas and the lazy ? :
  parser.EnableOptimizer(false);
  return parser;
}

void define(mu::Parser& parser, const std::string& name, Site& site) {
  const auto define = [&](auto* function) { parser.DefineFunUserData(name, function, &site, false); };
#define MESO_UNARY(op) \
  case Op::op:         \
    return define(&unary<Op::op>)
#define MESO_BINARY(op) \
  case Op::op:          \
    return define(&binary<Op::op>)
  switch (site.node->op) {
    MESO_UNARY(negate);
    MESO_UNARY(logical_not);
    MESO_UNARY(floor);
    MESO_UNARY(ceil);
    MESO_UNARY(round);
    MESO_UNARY(abs);
    MESO_UNARY(sign);
    MESO_UNARY(sqrt);
    MESO_UNARY(exp);
    MESO_UNARY(log);
    MESO_UNARY(sin);
    MESO_UNARY(cos);
    MESO_UNARY(tan);
    MESO_UNARY(asin);
    MESO_UNARY(acos);
    MESO_UNARY(atan);
    MESO_BINARY(add);
    MESO_BINARY(subtract);
    MESO_BINARY(multiply);
    MESO_BINARY(divide);
    MESO_BINARY(power);
    MESO_BINARY(less);
    MESO_BINARY(less_equal);
    MESO_BINARY(greater);
    MESO_BINARY(greater_equal);
    MESO_BINARY(equal);
    MESO_BINARY(not_equal);
    MESO_BINARY(mod);
    MESO_BINARY(atan2);
    MESO_BINARY(hypot);
    MESO_BINARY(min);
    MESO_BINARY(max);
    case Op::clamp:
      return define(&clamp);
    case Op::hash:
      return define(&hash);
    default:
      assert(false && "not an operation");
  }
#undef MESO_UNARY
#undef MESO_BINARY
}

}  // namespace

struct ExpressionProgram::Machine {
  explicit Machine(const expr::Expression& e) : expression(e) {
    try {
      compile();
      compiled = true;
    } catch (const mu::ParserError&) {  // has no base class; here it means: too long
      compiled = false;
    }
  }
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  void compile();
  std::string write(const Node& node, std::vector<std::string>& operands);

  expr::Expression expression;
  mu::Parser parser = empty_parser();
  std::vector<Site> sites;        ///< one per node; muParser keeps their addresses
  std::vector<double> variables;  ///< one per name; likewise
  const Node* failed = nullptr;
  bool compiled = false;
};

void ExpressionProgram::Machine::compile() {
  variables.resize(expression.names().size());
  for (std::size_t k = 0; k < variables.size(); ++k) parser.DefineVar("v" + std::to_string(k), &variables[k]);
  parser.DefineConst("yes", 1);
  parser.DefineConst("no", 0);
  sites.reserve(expression.nodes().size());
  std::vector<std::string> stack;
  for (const Node& node : expression.nodes()) {
    sites.push_back({&node, &failed});
    if (node.op >= Op::skip_if_zero) continue;  // muParser makes its own jumps
    const auto first = stack.end() - node.operands;
    std::vector<std::string> operands(std::make_move_iterator(first), std::make_move_iterator(stack.end()));
    stack.erase(first, stack.end());
    stack.push_back(write(node, operands));
  }
  parser.SetExpr(stack.front());
  (void)parser.Eval();  // compiles; the values do not matter yet
}

std::string ExpressionProgram::Machine::write(const Node& node, std::vector<std::string>& operands) {
  const std::string id = std::to_string(sites.size() - 1);
  switch (node.op) {
    case Op::number:  // by name: muParser's own way of reading numbers depends on the locale
      parser.DefineConst("c" + id, node.number);
      return "c" + id;
    case Op::name: {
      const std::string_view name = std::string_view(expression.text()).substr(node.offset, node.length);
      const auto& names = expression.names();
      const auto k = std::find_if(names.begin(), names.end(), [&](const expr::Name& n) { return n.text == name; });
      return "v" + std::to_string(k - names.begin());
    }
    case Op::select:
      return "((" + operands[0] + ")?(" + operands[1] + "):(" + operands[2] + "))";
    case Op::logical_and:
      return "((" + operands[0] + ")?((" + operands[1] + ")?yes:no):no)";
    case Op::logical_or:
      return "((" + operands[0] + ")?yes:((" + operands[1] + ")?yes:no))";
    default:
      break;
  }
  define(parser, "f" + id, sites.back());
  std::string call = "f" + id + "(";
  for (std::size_t i = 0; i < operands.size(); ++i) call += (i == 0 ? "" : ",") + operands[i];
  return call + ")";
}

ExpressionProgram::ExpressionProgram(const expr::Expression& expression)
    : machine_(std::make_unique<Machine>(expression)) {}
ExpressionProgram::ExpressionProgram(const ExpressionProgram& other)
    : machine_(std::make_unique<Machine>(other.machine_->expression)) {}
ExpressionProgram::ExpressionProgram(ExpressionProgram&&) noexcept = default;
ExpressionProgram& ExpressionProgram::operator=(ExpressionProgram other) noexcept {
  machine_ = std::move(other.machine_);
  return *this;
}
ExpressionProgram::~ExpressionProgram() = default;

bool ExpressionProgram::is_compiled() const { return machine_->compiled; }

expr::EvalResult ExpressionProgram::evaluate(std::span<const double> slots) {
  Machine& m = *machine_;
  if (!m.compiled) return expr::evaluate(m.expression, slots);
  const std::vector<expr::Name>& names = m.expression.names();
  for (std::size_t k = 0; k < names.size(); ++k) m.variables[k] = slots[names[k].slot];
  m.failed = nullptr;
  const double value = m.parser.Eval();
  if (m.failed != nullptr) return {.failed_offset = m.failed->offset, .failed_length = m.failed->length};
  return {.value = value};
}

}  // namespace meso::eval
