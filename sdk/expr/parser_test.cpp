// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "meso/base/number.hpp"
#include "meso/expr/expression.hpp"

namespace meso::expr {
namespace {

ParseResult parse(std::string_view text) { return parse_expression(text, LengthUnit::millimeter); }

/// The tree as text, prefix notation: "(+ 1 (* 2 x))"; numbers by value, operations by the number of Op.
std::string tree(std::string_view text) {
  static const std::vector<std::pair<Op, std::string>> names = {
      {Op::negate, "neg"},   {Op::logical_not, "not"},  {Op::add, "+"},
      {Op::subtract, "-"},   {Op::multiply, "*"},       {Op::divide, "/"},
      {Op::power, "^"},      {Op::less, "<"},           {Op::less_equal, "<="},
      {Op::greater, ">"},    {Op::greater_equal, ">="}, {Op::equal, "=="},
      {Op::not_equal, "!="}, {Op::logical_and, "and"},  {Op::logical_or, "or"},
      {Op::select, "?"},     {Op::min, "min"},          {Op::max, "max"},
      {Op::clamp, "clamp"},  {Op::hash, "hash"},        {Op::sin, "sin"},
      {Op::atan2, "atan2"}};
  const ParseResult result = parse(text);
  if (!result.expression) return "error";
  std::vector<std::string> stack;
  for (const Node& node : result.expression->nodes()) {
    if (node.op >= Op::skip_if_zero) continue;
    std::string term;
    if (node.op == Op::number) term = format_number(node.number);
    if (node.op == Op::name) term = result.expression->names()[node.index].text;
    for (const auto& [op, name] : names)
      if (op == node.op) term = "(" + name;
    const std::size_t first = stack.size() - node.operands;
    for (std::size_t i = first; i < stack.size(); ++i) term += " " + stack[i];
    if (node.operands > 0) term += ")";
    stack.resize(first);
    stack.push_back(term);
  }
  return stack.size() == 1 ? stack[0] : "broken tree";
}

/// "CODE at offset+length [argument] [argument]", or "fine".
std::string fault(std::string_view text) {
  const ParseResult result = parse(text);
  EXPECT_NE(result.expression.has_value(), result.error.has_value());
  if (!result.error) return "fine";
  const ParseError& e = *result.error;
  EXPECT_LE(e.offset + e.length, text.size());
  std::string out(info(e.code).name.substr(std::string_view("EXPRESSION_").size()));
  out += " at " + std::to_string(e.offset) + "+" + std::to_string(e.length);
  for (const std::string& arg : e.args) out += " [" + arg + "]";
  return out;
}

TEST(Parser, ReadsNumbers) {
  EXPECT_EQ(tree("5"), "5");
  EXPECT_EQ(tree("5."), "5");
  EXPECT_EQ(tree(".5"), "0.5");
  EXPECT_EQ(tree("1e3"), "1000");
  EXPECT_EQ(tree("1E+3mm"), "1000");
  EXPECT_EQ(tree("2cm"), "20");
  EXPECT_EQ(tree("1in"), "25.4");
  EXPECT_EQ(tree("180deg"), format_number(3.141592653589793));
  EXPECT_EQ(tree("pi"), format_number(3.141592653589793));
  EXPECT_EQ(tree(" \t\r\n7 "), "7");
}

TEST(Parser, ConvertsUnitsToTheDocuments) {
  EXPECT_EQ(parse_expression("25.4mm", LengthUnit::inch).expression->nodes()[0].number, 1);
  EXPECT_EQ(parse_expression("1ft", LengthUnit::inch).expression->nodes()[0].number, 12);
}

TEST(Parser, BindsFromLooseToTight) {
  EXPECT_EQ(tree("a or b and not c < d + e * -f ^ g"), "(or a (and b (not (< c (+ d (* e (neg (^ f g))))))))");
  EXPECT_EQ(tree("a ^ b * c + d < e and f or g ? h : i"), "(? (or (and (< (+ (* (^ a b) c) d) e) f) g) h i)");
}

TEST(Parser, GroupsToTheLeft) {
  EXPECT_EQ(tree("a - b + c"), "(+ (- a b) c)");
  EXPECT_EQ(tree("a / b * c"), "(* (/ a b) c)");
  EXPECT_EQ(tree("a and b and c"), "(and (and a b) c)");
  EXPECT_EQ(tree("a or b or c"), "(or (or a b) c)");
}

TEST(Parser, GroupsPowersAndConditionsToTheRight) {
  EXPECT_EQ(tree("a ^ b ^ c"), "(^ a (^ b c))");
  EXPECT_EQ(tree("a ? b : c ? d : e"), "(? a b (? c d e))");
  EXPECT_EQ(tree("a ? b ? c : d : e"), "(? a (? b c d) e)");
}

TEST(Parser, MinusIsLooserThanPower) {
  EXPECT_EQ(tree("-2 ^ 2"), "(neg (^ 2 2))");
  EXPECT_EQ(tree("2 ^ -1"), "(^ 2 (neg 1))");
  EXPECT_EQ(tree("2 ^ -3 ^ 4 * 5"), "(* (^ 2 (neg (^ 3 4))) 5)");
  EXPECT_EQ(tree("- - a"), "(neg (neg a))");
  EXPECT_EQ(tree("-a * b"), "(* (neg a) b)");
  EXPECT_EQ(tree("a--b"), "(- a (neg b))");
}

TEST(Parser, NotIsLooserThanComparison) {
  EXPECT_EQ(tree("not a < b"), "(not (< a b))");
  EXPECT_EQ(tree("not not a"), "(not (not a))");
  EXPECT_EQ(tree("not a and b"), "(and (not a) b)");
}

TEST(Parser, ParenthesesGroupAndLeaveNoNode) {
  EXPECT_EQ(tree("(a + b) * (c)"), "(* (+ a b) c)");
  EXPECT_EQ(tree("(a < b) == (c < d)"), "(== (< a b) (< c d))");
  EXPECT_EQ(tree("-(2) ^ 2"), "(neg (^ 2 2))");
}

TEST(Parser, CallsFunctions) {
  EXPECT_EQ(tree("atan2(a, b ? c : d)"), "(atan2 a (? b c d))");
  EXPECT_EQ(tree("clamp (a,b,c)"), "(clamp a b c)");
  EXPECT_EQ(tree("min(a, b, c)"), "(min (min a b) c)");
  EXPECT_EQ(tree("max(a)"), "a");
  EXPECT_EQ(tree("hash(a, b, c)"), "(hash a b c)");
}

TEST(Parser, KnowsEveryNodesPlace) {
  const ParseResult result = parse(" min( a+b, (c), -d)/2mm");
  std::vector<std::string> places;
  for (const Node& n : result.expression->nodes())
    places.emplace_back(result.expression->text().substr(n.offset, n.length));
  EXPECT_EQ(places, (std::vector<std::string>{"a", "b", "a+b", "c", "min( a+b, (c), -d)", "d", "-d",
                                              "min( a+b, (c), -d)", "2mm", "min( a+b, (c), -d)/2mm"}));
}

TEST(Parser, CollectsNamesInOrderOfFirstUse) {
  const ParseResult result = parse("b + global.x * a + b + stress.s1 - sqrt(pi)");
  const std::vector<Name> expected = {{"b", 0, 0}, {"global.x", 4, 1}, {"a", 15, 2}, {"stress.s1", 23, 3}};
  EXPECT_EQ(result.expression->names(), expected);
  EXPECT_FALSE(result.expression->is_constant());
  EXPECT_TRUE(parse("2 * sin(30deg) * pi").expression->is_constant());
}

TEST(Parser, UnitNamesAreOrdinaryNames) {
  EXPECT_EQ(tree("m * 2m"), "(* m 2000)");
  EXPECT_EQ(tree("in + deg"), "(+ in deg)");
}

TEST(ParserFaults, Empty) {
  EXPECT_EQ(fault(""), "EMPTY at 0+0");
  EXPECT_EQ(fault("  "), "EMPTY at 0+2");
}

TEST(ParserFaults, Characters) {
  EXPECT_EQ(fault("1 + $"), "UNEXPECTED_CHARACTER at 4+1 [$]");
  EXPECT_EQ(fault("a.b.c"), "UNEXPECTED_CHARACTER at 3+1 [.]");
  EXPECT_EQ(fault("1,5"), "UNEXPECTED_CHARACTER at 1+1 [,]");
  EXPECT_EQ(fault("(1,5)"), "UNEXPECTED_CHARACTER at 2+1 [,]");
  EXPECT_EQ(fault("1 + €"), "UNEXPECTED_CHARACTER at 4+3 [€]");
  EXPECT_EQ(fault("a\xE2\x82"), "UNEXPECTED_CHARACTER at 1+1 [\\xE2]");
  EXPECT_EQ(fault(std::string_view("1\0", 2)), "UNEXPECTED_CHARACTER at 1+1 [\\x00]");
}

TEST(ParserFaults, SignsFromElsewhere) {
  EXPECT_EQ(fault("a && b"), "FOREIGN_SYMBOL at 2+2 [&&] [and]");
  EXPECT_EQ(fault("!a"), "FOREIGN_SYMBOL at 0+1 [!] [not]");
  EXPECT_EQ(fault("2**3"), "FOREIGN_SYMBOL at 1+2 [**] [^]");
  EXPECT_EQ(fault("5 − 3"), "FOREIGN_SYMBOL at 2+3 [−] [-]");
  EXPECT_EQ(fault("30°"), "FOREIGN_SYMBOL at 2+2 [°] [deg]");
  EXPECT_EQ(fault("a = b"), "ASSIGNMENT at 2+1");
}

TEST(ParserFaults, Operands) {
  EXPECT_EQ(fault("1 +"), "MISSING_OPERAND at 3+0 [the end]");
  EXPECT_EQ(fault("1 + * 2"), "MISSING_OPERAND at 4+1 ['*']");
  EXPECT_EQ(fault("+1"), "MISSING_OPERAND at 0+1 ['+']");
  EXPECT_EQ(fault("()"), "MISSING_OPERAND at 1+1 [')']");
  EXPECT_EQ(fault("1 + not a"), "MISSING_OPERAND at 4+3 ['not']");
  EXPECT_EQ(fault("min(1,)"), "MISSING_OPERAND at 6+1 [')']");
  EXPECT_EQ(fault("a and and b"), "MISSING_OPERAND at 6+3 ['and']");
}

TEST(ParserFaults, Operators) {
  EXPECT_EQ(fault("2 x"), "MISSING_OPERATOR at 2+1 ['x']");
  EXPECT_EQ(fault("2(x)"), "MISSING_OPERATOR at 1+1 ['(']");
  EXPECT_EQ(fault("min(1 2)"), "MISSING_OPERATOR at 6+1 ['2']");
  EXPECT_EQ(fault("1.2.3"), "MISSING_OPERATOR at 3+2 ['.3']");
  EXPECT_EQ(fault("a not b"), "MISSING_OPERATOR at 2+3 ['not']");
}

TEST(ParserFaults, Pairs) {
  EXPECT_EQ(fault("(1 + 2"), "UNBALANCED at 0+1 [(] [)]");
  EXPECT_EQ(fault("sin(1"), "UNBALANCED at 3+1 [(] [)]");
  EXPECT_EQ(fault("1)"), "UNBALANCED at 1+1 [)] [(]");
  EXPECT_EQ(fault(")"), "UNBALANCED at 0+1 [)] [(]");
  EXPECT_EQ(fault("a ? b"), "UNBALANCED at 2+1 [?] [:]");
  EXPECT_EQ(fault("(a ? b)"), "UNBALANCED at 3+1 [?] [:]");
  EXPECT_EQ(fault("a : b"), "UNBALANCED at 2+1 [:] [?]");
}

TEST(ParserFaults, Functions) {
  EXPECT_EQ(fault("flor(x)"), "UNKNOWN_FUNCTION at 0+4 [flor] [; did you mean 'floor'?]");
  EXPECT_EQ(fault("rnd()"), "UNKNOWN_FUNCTION at 0+3 [rnd] []");
  EXPECT_EQ(fault("pi(2)"), "UNKNOWN_FUNCTION at 0+2 [pi] []");
  EXPECT_EQ(fault("1 + sin"), "BARE_FUNCTION at 4+3 [sin]");
  EXPECT_EQ(fault("2*atan2( 1 )"), "ARGUMENT_COUNT at 2+10 [atan2] [2 arguments] [1]");
  EXPECT_EQ(fault("sin(1, 2)"), "ARGUMENT_COUNT at 0+9 [sin] [1 argument] [2]");
  EXPECT_EQ(fault("min()"), "ARGUMENT_COUNT at 0+5 [min] [1 or more arguments] [0]");
  EXPECT_EQ(fault("hash(1,2,3,4,5,6,7,8,9)"), "ARGUMENT_COUNT at 0+23 [hash] [1 to 8 arguments] [9]");
}

TEST(ParserFaults, UnitsAndRanges) {
  EXPECT_EQ(fault("5mn"), "UNKNOWN_UNIT at 1+2 [mn] [; did you mean 'mm'?]");
  EXPECT_EQ(fault("5MM"), "UNKNOWN_UNIT at 1+2 [MM] [; did you mean 'mm'?]");
  EXPECT_EQ(fault("2x"), "UNKNOWN_UNIT at 1+1 [x] []");
  EXPECT_EQ(fault("2e"), "UNKNOWN_UNIT at 1+1 [e] []");
  EXPECT_EQ(fault("0x10"), "UNKNOWN_UNIT at 1+3 [x10] []");
  EXPECT_EQ(fault("5milimeter"), "UNKNOWN_UNIT at 1+9 [milimeter] [; did you mean 'mm'?]");
  EXPECT_EQ(fault("5inch"), "UNKNOWN_UNIT at 1+4 [inch] [; did you mean 'in'?]");
  EXPECT_EQ(fault("10 degrees"), "MISSING_OPERATOR at 3+7 ['degrees'; did you mean 'deg'?]");
  EXPECT_EQ(fault("10 mm"), "UNIT_APART at 3+2 [mm]");
  EXPECT_EQ(fault("10mm mm"), "MISSING_OPERATOR at 5+2 ['mm']");
  EXPECT_EQ(fault("1 + 1e999"), "NUMBER_RANGE at 4+5 [1e999]");
  EXPECT_EQ(fault("1e-400mm"), "NUMBER_RANGE at 0+8 [1e-400mm]");
}

TEST(ParserFaults, ChainedComparisons) {
  EXPECT_EQ(fault("a < b < c"), "CHAINED_COMPARISON at 6+1 [<]");
  EXPECT_EQ(fault("a == b != c"), "CHAINED_COMPARISON at 7+2 [!=]");
  EXPECT_EQ(fault("a < b and b < c"), "fine");
}

TEST(ParserFaults, Limits) {
  EXPECT_EQ(fault(std::string(65537, '1')), "TOO_LONG at 0+65537 [65537] [65536]");
  const std::string open(201, '(');
  EXPECT_EQ(fault(open + "1" + std::string(201, ')')), "TOO_DEEP at 200+1 [200]");
  EXPECT_EQ(fault(open.substr(1) + "1" + std::string(200, ')')), "fine");
  EXPECT_EQ(fault(std::string(201, '-') + "1"), "TOO_DEEP at 200+1 [200]");
  std::string powers = "1";
  std::string conditions = "1";
  for (int i = 0; i < 201; ++i) {
    powers += "^1";
    conditions += "?1:1";
  }
  EXPECT_EQ(fault(powers), "TOO_DEEP at 401+1 [200]");
  EXPECT_EQ(fault(conditions), "TOO_DEEP at 801+1 [200]");
}

TEST(ParserFaults, LongFlatTextsAreFine) {
  std::string sum = "1";
  std::string least = "min(1";
  std::string different = "a0";
  for (int i = 1; i < 9000; ++i) {
    sum += "+1";
    least += ",1";
    different += "+a" + std::to_string(i);
  }
  EXPECT_EQ(fault(sum), "fine");
  EXPECT_EQ(fault(least + ")"), "fine");
  EXPECT_EQ(parse(different).expression->names().size(), 9000);
}

/// Any mixture of the grammar's pieces is a tree or one fault inside the text, and the same again.
TEST(ParserFaults, NoTextIsTooStrange) {
  constexpr std::string_view pieces[] = {"1",     "2mm",  "a",     "x.y", "sin", "min", "(",    ")", ",",
                                         "+",     "-",    "*",     "/",   "^",   "<",   "==",   "?", ":",
                                         " and ", " or ", " not ", "pi",  "=",   "$",   "\xC3", " ", "."};
  std::mt19937 random(1);
  int fine = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string text;
    for (std::size_t n = random() % 9; n-- > 0;) text += pieces[random() % std::size(pieces)];
    if (fault(text) == "fine") {
      EXPECT_NE(tree(text), "broken tree") << text;
      ++fine;
    }
  }
  EXPECT_GT(fine, 100);
}

TEST(List, SplitsAtOuterCommas) {
  const std::vector<ListItem> items = split_list("1, min(2, 3) ,-a");
  ASSERT_EQ(items.size(), 3);
  EXPECT_EQ(items[0].text, "1");
  EXPECT_EQ(items[1].text, " min(2, 3) ");
  EXPECT_EQ(items[1].offset, 2);
  EXPECT_EQ(items[2].text, "-a");
  EXPECT_EQ(items[2].offset, 14);
}

TEST(List, KeepsEmptyItems) {
  EXPECT_EQ(split_list("").size(), 1);
  EXPECT_EQ(split_list(",").size(), 2);
  EXPECT_EQ(split_list("1,").back().offset, 2);
  EXPECT_EQ(split_list("1),2").size(), 2);
}

TEST(Names, AreValidOrNot) {
  EXPECT_TRUE(is_valid_name("_a9"));
  EXPECT_TRUE(is_valid_name("Pitch"));
  for (const char* bad : {"", "9a", "a-b", "a.b", "ä", "a b"}) EXPECT_FALSE(is_valid_name(bad)) << bad;
}

TEST(Names, OfTheLanguageAreReserved) {
  for (const char* name : {"sin", "hash", "pi", "and", "or", "not", "global"})
    EXPECT_TRUE(is_reserved_name(name)) << name;
  for (const char* name : {"mm", "e", "x", "Sin", "i"}) EXPECT_FALSE(is_reserved_name(name)) << name;
}

}  // namespace
}  // namespace meso::expr
