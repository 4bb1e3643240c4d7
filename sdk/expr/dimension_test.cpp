// SPDX-License-Identifier: Apache-2.0
#include "meso/expr/dimension.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

namespace meso::expr {
namespace {

/// "length", "angle", "number", "open", or "'5mm' and '3deg' at 0+10". wall is a length, turn an angle, i an index.
std::string dimension(std::string_view text) {
  static const std::map<std::string, Dimension, std::less<>> known = {
      {"wall", Dimension::length}, {"turn", Dimension::angle}, {"i", Dimension::number}};
  const ParseResult parsed = parse_expression(text, LengthUnit::millimeter);
  if (!parsed.expression) return "error";
  std::vector<Dimension> names;
  for (const Name& name : parsed.expression->names()) {
    const auto found = known.find(name.text);
    names.push_back(found == known.end() ? Dimension::open : found->second);
  }
  const DimensionResult result = dimension_of(*parsed.expression, names);
  if (const auto& c = result.clash)
    return "'" + std::string(c->first) + "' and '" + std::string(c->second) + "' at " + std::to_string(c->offset) +
           "+" + std::to_string(c->length);
  static const char* const texts[] = {"open", "number", "length", "angle"};
  return texts[static_cast<std::size_t>(result.dimension)];
}

TEST(Dimension, IsThatOfTheWrittenUnit) {
  for (const char* length : {"5mm", "1um", "2.5e-3m", "3in", "1ft", "2cm", "-5mm", "(5mm)", "wall", "abs(wall)"})
    EXPECT_EQ(dimension(length), "length") << length;
  for (const char* angle : {"5deg", "1rad", ".5deg", "-turn"}) EXPECT_EQ(dimension(angle), "angle") << angle;
  for (const char* open : {"5", "1e3", "pi", "x", "2*pi"}) EXPECT_EQ(dimension(open), "open") << open;
}

TEST(Dimension, OfSumsBindsWhatHasNoUnit) {
  EXPECT_EQ(dimension("1 + 2mm - x"), "length");
  EXPECT_EQ(dimension("x + 30deg"), "angle");
  EXPECT_EQ(dimension("max(0, x, turn)"), "angle");
  EXPECT_EQ(dimension("i > 2 ? 1 : wall"), "length");
  EXPECT_EQ(dimension("mod(x, 4mm)"), "length");
}

TEST(Dimension, OfProducts) {
  EXPECT_EQ(dimension("i*wall"), "length");
  EXPECT_EQ(dimension("5mm*sin(turn)"), "length");
  EXPECT_EQ(dimension("5mm/cos(30deg)"), "length");
  EXPECT_EQ(dimension("wall/1mm"), "number");
  EXPECT_EQ(dimension("hash(1, i)*360deg"), "angle");
  EXPECT_EQ(dimension("30deg*(wall/5mm)^(1mm/1mm)"), "angle");
  EXPECT_EQ(dimension("10mm < wall"), "number");
}

// Each of these may be meant as a length, as an angle, or as neither.
TEST(Dimension, SaysNothingWhereAUnitMayHideInANumber) {
  for (const char* text : {"0.1*wall", "wall/20", "5*turn", "turn*wall", "wall*wall", "wall^2", "sqrt(wall*wall)",
                           "1/wall", "wall/turn", "x*3deg/10mm", "4mm*x/1rad", "atan2(wall, 5mm)", "asin(0.5)"})
    EXPECT_EQ(dimension(text), "open") << text;
  for (const char* sum : {"3mm + 0.5*turn", "turn + 0.05*wall", "wall + x", "x + turn"})
    EXPECT_EQ(dimension(sum).find(" and "), std::string::npos) << sum;
}

TEST(Dimension, LengthsAndAnglesDoNotMeet) {
  EXPECT_EQ(dimension("5mm + 3deg"), "'5mm' and '3deg' at 0+10");
  EXPECT_EQ(dimension("2*(wall - turn)"), "'wall' and 'turn' at 3+11");
  EXPECT_EQ(dimension("1 + i*2mm - 3 > 4rad"), "'2mm' and '4rad' at 0+20");
  EXPECT_EQ(dimension("max(1, 2mm, 3deg)"), "'2mm' and '3deg' at 0+17");
  EXPECT_EQ(dimension("clamp(x, 2deg, 3mm)"), "'2deg' and '3mm' at 0+19");
  EXPECT_EQ(dimension("x > 0 ? wall : 3deg"), "'wall' and '3deg' at 0+19");
  EXPECT_EQ(dimension("sin(30deg + wall)"), "'30deg' and 'wall' at 4+12");
  EXPECT_EQ(dimension("x > 0 and wall == turn"), "'wall' and 'turn' at 10+12");
}

}  // namespace
}  // namespace meso::expr
