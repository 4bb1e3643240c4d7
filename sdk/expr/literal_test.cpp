// SPDX-License-Identifier: Apache-2.0
#include "literal.hpp"

#include <gtest/gtest.h>

#include <array>
#include <numbers>
#include <random>
#include <string>

#include "literal_truth.hpp"
#include "meso/base/number.hpp"

namespace meso::expr {
namespace {

TEST(Literal, RoundsCorrectlyInEveryUnit) {
  for (const LiteralTruth& truth : literal_truths)
    EXPECT_EQ(literal_value(truth.decimal, *find_suffix(truth.suffix), truth.document_unit), truth.value)
        << truth.decimal << truth.suffix << " in unit " << static_cast<int>(truth.document_unit);
}

TEST(Literal, IsTheNumberItselfWithoutConversion) {
  EXPECT_EQ(literal_value("0.1", Suffix::none, LengthUnit::inch), 0.1);
  EXPECT_EQ(literal_value("0.1", Suffix::in, LengthUnit::inch), 0.1);
  EXPECT_EQ(literal_value("0.1", Suffix::rad, LengthUnit::inch), 0.1);
  EXPECT_EQ(literal_value("5.", Suffix::none, LengthUnit::inch), 5.0);
  EXPECT_EQ(literal_value("007.50", Suffix::none, LengthUnit::inch), 7.5);
}

// Writing the same length in metres by moving the decimal point must give the bits that the standard library reads.
TEST(Literal, AgreesWithTheNumberReaderUnderPowersOfTen) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 5000; ++i) {
    const std::string digits = std::to_string(random());
    const int exponent = static_cast<int>(random() % 600) - 320;
    const auto ours = literal_value(digits + "e" + std::to_string(exponent), Suffix::m, LengthUnit::micrometer);
    EXPECT_EQ(ours, parse_number(digits + "e" + std::to_string(exponent + 6))) << digits << "e" << exponent;
  }
}

TEST(Literal, ZeroNeedsNoRange) {
  for (const char* zero : {"0", "0.0", "0e999999999999", "0.000e-99999", ".0"})
    for (const Suffix suffix : {Suffix::none, Suffix::mm, Suffix::deg})
      EXPECT_EQ(literal_value(zero, suffix, LengthUnit::inch), 0.0) << zero;
}

TEST(Literal, RefusesWhatNoDoubleHolds) {
  for (const char* text : {"1e999", "1e-999", "1e99999999999999999999", "1e-99999999999999999999", "2e308"})
    for (const Suffix suffix : {Suffix::none, Suffix::m, Suffix::in})
      EXPECT_EQ(literal_value(text, suffix, LengthUnit::millimeter), std::nullopt) << text;
  EXPECT_EQ(literal_value("1e308", Suffix::mm, LengthUnit::micrometer), std::nullopt);
  EXPECT_EQ(literal_value("4e-324", Suffix::um, LengthUnit::meter), std::nullopt);
}

TEST(Literal, UnitsBringValuesBackIntoRange) {
  EXPECT_EQ(literal_value("1e309", Suffix::um, LengthUnit::millimeter), 1e306);
  EXPECT_EQ(literal_value("1e-325", Suffix::m, LengthUnit::millimeter), 1e-322);
}

TEST(Literal, FullTurnsAreTheDoublesNearestToPi) {
  EXPECT_EQ(literal_value("180", Suffix::deg, LengthUnit::millimeter), std::numbers::pi);
  EXPECT_EQ(literal_value("90", Suffix::deg, LengthUnit::millimeter), std::numbers::pi / 2);
  EXPECT_EQ(literal_value("360", Suffix::deg, LengthUnit::millimeter), std::numbers::pi * 2);
}

TEST(Literal, TakesManyDigits) {
  const std::string zeros(60000, '0');
  EXPECT_EQ(literal_value("0." + zeros + "1e60001", Suffix::in, LengthUnit::millimeter), 25.4);
  EXPECT_EQ(literal_value("1" + zeros + "e-60000", Suffix::in, LengthUnit::millimeter), 25.4);
  // Exactly between 1 mm and the next double: ties go to even, and one unit in the 60000th place decides otherwise.
  const std::string halfway = "0.00100000000000000011102230246251565404236316680908203125";
  EXPECT_EQ(literal_value(halfway, Suffix::m, LengthUnit::millimeter), 1.0);
  EXPECT_EQ(literal_value(halfway + zeros + "1", Suffix::m, LengthUnit::millimeter), 1.0000000000000002);
}

}  // namespace
}  // namespace meso::expr
