// SPDX-License-Identifier: Apache-2.0
#include "meso/export_step/write_step.hpp"

#include <gtest/gtest.h>

#include "step_text.hpp"

namespace meso {
namespace {

using step::NoName, step::Quoted, step::Ref, step::StepText;

std::string data_of(const auto& write) {
  StringSink sink;
  StepText text(sink);
  write(text);
  text.flush();
  EXPECT_EQ(text.bytes(), sink.text().size());
  return sink.text();
}

TEST(StepText, RealsAlwaysHaveAPoint) {
  EXPECT_EQ(data_of([](StepText& t) { t.entity("P", NoName{}, Vec3{5, 1e-6, -0.0}); }), "#1=P('',(5.,1.E-06,0.));\n");
  EXPECT_EQ(data_of([](StepText& t) { t.entity("P", 0.1, 1.5e-7, -2e30); }), "#1=P(0.1,1.5E-07,-2.E+30);\n");
}

TEST(StepText, ArgumentsHaveTheirSpelling) {
  EXPECT_EQ(data_of([](StepText& t) {
              const auto a = t.entity("A", true, 3);
              t.entity("B", Ref{a}, false, std::vector<step::StepId>{a, a}, std::vector<int>{});
            }),
            "#1=A(.T.,3);\n#2=B(#1,.F.,(#1,#1),());\n");
}

TEST(StepText, StringsAreEncoded) {
  EXPECT_EQ(data_of([](StepText& t) { t.entity("S", Quoted{"it's a\\b \xC3\xA9"}); }),
            "#1=S('it''s a\\\\b \\X4\\000000E9\\X0\\');\n");
}

TEST(StepText, AFullDiskIsNotForgotten) {
  struct FullDisk final : ByteSink {
    bool write(std::string_view) override { return ++writes != 2; }
    int writes = 0;
  } disk;
  StepText text(disk);
  const std::string name(1000, 'x');
  for (int i = 0; i < 5000; ++i) text.entity("E", Quoted{name});
  text.flush();
  EXPECT_FALSE(text.ok());
  EXPECT_EQ(disk.writes, 2);
}

TEST(StepText, SurvivesTheEdgeOfItsBuffer) {
  std::string expected, name(999, 'x');
  const std::string text = data_of([&](StepText& t) {
    for (int i = 1; i <= 3000; ++i) {
      t.entity("E", Quoted{name}, 0.1);
      expected += "#" + std::to_string(i) + "=E('" + name + "',0.1);\n";
    }
  });
  EXPECT_EQ(text, expected);
}

TEST(WriteStep, HeaderHasNoClock) {
  StringSink sink;
  EXPECT_TRUE(write_step({}, {.name = "a part"}, sink).complete);
  EXPECT_NE(sink.text().find("FILE_NAME('a part','1970-01-01T00:00:00'"), std::string::npos);
  StringSink later;
  EXPECT_TRUE(write_step({}, {.schema = StepSchema::ap242, .timestamp = 951'826'154}, later).complete);
  EXPECT_NE(later.text().find("'2000-02-29T12:09:14'"), std::string::npos);
  EXPECT_NE(later.text().find("AP242"), std::string::npos);
}

TEST(WriteStep, StopsWithItsSink) {
  class Full final : public ByteSink {
   public:
    [[nodiscard]] bool write(std::string_view) override { return false; }
  } full;
  EXPECT_FALSE(write_step({}, {}, full).complete);
}

}  // namespace
}  // namespace meso
