// SPDX-License-Identifier: Apache-2.0
#include "meso/import_field_csv/read_csv.hpp"

#include <gmock/gmock.h>

namespace meso {
namespace {

using testing::ElementsAre;

std::vector<double> values(const fields::Table& table) {
  std::vector<double> all;
  for (std::size_t r = 0; r < table.records.rows(); ++r)
    for (std::size_t c = 0; c < table.records.columns(); ++c) all.push_back(table.records(r, c));
  return all;
}

fields::Table table_of(const std::string& text) {
  DiagnosticSink sink;
  auto table = read_field_csv(text, "t.csv", {}, sink);
  if (!table) throw std::invalid_argument(render(sink.diagnostics().at(0)));
  return *table;
}

std::string fault_of(const std::string& text) {
  DiagnosticSink sink;
  EXPECT_FALSE(read_field_csv(text, "t.csv", {}, sink));
  EXPECT_EQ(sink.diagnostics().size(), 1U);
  return render(sink.diagnostics().at(0));
}

TEST(FieldCsv, ReadsHeadingUnitsAndNumbers) {
  const fields::Table table = table_of("x [mm], von-Mises (MPa)\n\n# a remark\n1,2e3\n-.5,+7\r\n");
  ASSERT_EQ(table.columns.size(), 2U);
  EXPECT_EQ(table.columns[0].name, "x");
  EXPECT_EQ(table.columns[0].unit, "mm");
  EXPECT_EQ(table.columns[1].name, "von_Mises");
  EXPECT_EQ(table.columns[1].unit, "MPa");
  EXPECT_THAT(values(table), ElementsAre(1, 2000, -0.5, 7));
}

TEST(FieldCsv, NeedsNoHeadingAndTakesOtherSeparators) {
  const fields::Table table = table_of("1;2;3\n4;5;6");
  EXPECT_TRUE(table.columns.empty());
  EXPECT_THAT(values(table), ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(values(table_of("1\t2\n")), ElementsAre(1, 2));
}

TEST(FieldCsv, ATableWithoutNamesIsReadWithAWarning) {
  DiagnosticSink sink;
  ASSERT_TRUE(read_field_csv("# from a script\n1,2\n3,4\n", "t.csv", {}, sink));
  ASSERT_EQ(sink.diagnostics().size(), 1U);
  EXPECT_THAT(render(sink.diagnostics()[0]), testing::HasSubstr("t.csv:2:1: warning FIELD_NO_HEADING: the first line "
                                                                "has no names: its 2 columns are taken in the order"));
  DiagnosticSink none;
  ASSERT_TRUE(read_field_csv("a,b\n1,2\n", "t.csv", {}, none));
  EXPECT_TRUE(none.diagnostics().empty());
}

// Beyond a quarter of the budget numbers stand in a file; where there is no room for it, that is said.
TEST(FieldCsv, ManyNumbersGoToAFile) {
  std::string text = "a,b\n";
  for (int i = 0; i < 40000; ++i) text += std::to_string(i) + "," + std::to_string(-i) + "\n";
  const RunOptions little{.max_memory_bytes = 100'000};
  DiagnosticSink sink;
  const auto table = read_field_csv(text, "t.csv", little, sink);
  ASSERT_TRUE(table);
  ASSERT_EQ(table->records.rows(), 40000U);
  for (std::size_t i = 0; i < 40000; ++i) ASSERT_EQ(table->records(i, 1), -static_cast<double>(i));
  setenv("TMPDIR", "/nowhere", 1);
  EXPECT_TRUE(read_field_csv(text, "t.csv", {}, sink));
  EXPECT_FALSE(read_field_csv(text, "t.csv", little, sink));
  unsetenv("TMPDIR");
  ASSERT_EQ(sink.diagnostics().size(), 1U);
  EXPECT_THAT(render(sink.diagnostics()[0]), testing::HasSubstr("FIELD_NO_SPACE: the numbers take 0 MiB, more than "
                                                                "memory may hold, and the folder '/nowhere' has no"));
}

TEST(FieldCsv, ObeysItsBudgets) {
  std::string text = "a,b\n";
  for (int i = 0; i < 40000; ++i) text += "1,2\n";
  const auto fault = [&](const RunOptions& run) {
    DiagnosticSink sink;
    EXPECT_FALSE(read_field_csv(text, "t.csv", run, sink));
    return sink.diagnostics().size() == 1 ? sink.diagnostics()[0].code : Code::internal;
  };
  EXPECT_EQ(fault({.deadline = std::chrono::steady_clock::now() - std::chrono::seconds(1)}), Code::limit_time);
  EXPECT_EQ(fault({.cancelled = [] { return true; }}), Code::cancelled);
}

TEST(FieldCsv, NumbersReadBackAsTheyWereWritten) {
  EXPECT_THAT(values(table_of("0.1,4.9e-324,1.7976931348623157e308\n")),
              ElementsAre(0.1, 4.9e-324, 1.7976931348623157e308));
}

TEST(FieldCsv, SaysWhereItIsWrong) {
  EXPECT_THAT(fault_of("x,y\n1,2\n3,4x\n"),
              testing::HasSubstr("t.csv:3:3: error FIELD_FILE_SYNTAX: expected a number, found '4x'"));
  EXPECT_THAT(fault_of("1,2\n3\n"),
              testing::HasSubstr("t.csv:2:2: error FIELD_FILE_SYNTAX: expected 2 cells, found '1'"));
  EXPECT_THAT(fault_of("1,2\n3,4,5\n"),
              testing::HasSubstr("t.csv:2:5: error FIELD_FILE_SYNTAX: expected the end of the line"));
  EXPECT_THAT(fault_of("x,y\n1,\n"), testing::HasSubstr("expected a number, found ''"));
  EXPECT_THAT(fault_of("x,y\n"), testing::HasSubstr("FIELD_FILE_EMPTY"));
  EXPECT_THAT(fault_of(""), testing::HasSubstr("FIELD_FILE_EMPTY"));
}

}  // namespace
}  // namespace meso
