// SPDX-License-Identifier: Apache-2.0
#include "meso/export_step/write_step.hpp"

#include <gtest/gtest.h>

#include "step_text.hpp"

namespace meso {
namespace {

using step::NoName, step::Quoted, step::Ref, step::StepText;

std::string data_of(const auto& write) {
  ByteBuffer buffer;
  StepText text(&buffer);
  write(text);
  StepText counting(nullptr);
  write(counting);
  EXPECT_EQ(counting.last(), text.last());
  return std::string(buffer.view());
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

/// A sheet of unit squares that share edges and vertices. Not closed, which no writer looks at.
brep::Shell sheet(int edge, Vec3 at) {
  brep::Template geometry;
  geometry.vertices = {{0, 0, 0}};
  geometry.edges = {{.curve = brep::Line{{}, {1, 0, 0}}, .vertex_offset = {{{0, 0, 0}, {1, 0, 0}}}},
                    {.curve = brep::Line{{}, {0, 1, 0}}, .vertex_offset = {{{0, 0, 0}, {0, 1, 0}}}}};
  brep::FaceTemplate square{.surface = brep::Plane{}};
  square.loops = {{{0, {0, 0, 0}, false}, {1, {1, 0, 0}, false}, {0, {0, 1, 0}, true}, {1, {0, 0, 0}, true}}};
  geometry.faces = {square};
  return {std::make_shared<const brep::Template>(geometry), Affine::from_translation(at),
          [edge](const std::function<void(const brep::FaceInstance&)>& visit) {
            for (int i = 0; i < edge; ++i)
              for (int k = 0; k < edge; ++k) visit({0, {i, k, 0}});
          }};
}

std::string step(const brep::Body& body, unsigned jobs) {
  StringSink sink;
  const StepCounts counts = write_step(body, {.jobs = jobs}, sink);
  EXPECT_TRUE(counts.complete);
  EXPECT_EQ(counts.bytes, sink.text().size());
  std::size_t entities = 0;
  for (std::size_t at = sink.text().find(";\n#"); at != std::string::npos; at = sink.text().find(";\n#", at + 1)) {
    ++entities;
    const std::string begin = "#" + std::to_string(entities) + "=";
    if (sink.text().compare(at + 2, begin.size(), begin) != 0) {
      ADD_FAILURE() << "entity " << entities << " has another number with " << jobs << " jobs";
      break;
    }
  }
  EXPECT_EQ(entities, counts.entities);
  return sink.text();
}

std::size_t count_of(std::string_view text, std::string_view word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

TEST(WriteStep, ThreadsDoNotChangeTheBytes) {
  brep::Body body;
  body.solids = {{sheet(70, {}), {sheet(1, {9, 9, 9}), sheet(40, {0, 0, 5})}}, {sheet(2, {0, 0, 7}), {}}};
  for (int i = 0; i < 300; ++i) body.solids[1].voids.push_back(sheet(3, {1.0 * i, 0, 0}));
  const std::string one = step(body, 1);
  for (const unsigned jobs : {2u, 5u, 0u}) EXPECT_TRUE(step(body, jobs) == one) << jobs << " jobs";
  const std::size_t faces = 70 * 70 + 1 + 40 * 40 + 4 + 300 * 9;
  const std::size_t vertices = 71 * 71 + 4 + 41 * 41 + 9 + 300 * 16;
  EXPECT_EQ(count_of(one, "=ADVANCED_FACE("), faces);
  EXPECT_EQ(count_of(one, "=VERTEX_POINT("), vertices);
  EXPECT_EQ(count_of(one, "=EDGE_CURVE("), 2 * 70 * 71 + 4 + 2 * 40 * 41 + 12 + 300 * 24);
  EXPECT_EQ(count_of(one, "=BREP_WITH_VOIDS("), 2);
  EXPECT_EQ(count_of(one, "=ORIENTED_CLOSED_SHELL("), 302);
}

TEST(WriteStep, ShellsBeyondOneGroupShareTheirNumbers) {
  brep::Body body;
  body.solids = {{sheet(200, {}), {sheet(200, {0, 0, 1})}}, {sheet(2, {0, 0, 2}), {}}};
  const std::string one = step(body, 1);
  EXPECT_TRUE(step(body, 2) == one);
  EXPECT_EQ(count_of(one, "=VERTEX_POINT("), 2 * 201 * 201 + 9);
}

class FullDisk final : public ByteSink {
 public:
  explicit FullDisk(int room) : room_(room) {}
  [[nodiscard]] bool write(std::string_view) override { return ++writes <= room_; }
  int writes = 0;

 private:
  int room_;
};

TEST(WriteStep, AFullDiskEndsAllThreads) {
  const brep::Body body{.solids = {{sheet(100, {}), {}}}};
  for (const unsigned jobs : {1u, 3u})
    for (const int room : {1, 2, 5}) {
      FullDisk disk(room);
      EXPECT_FALSE(write_step(body, {.jobs = jobs}, disk).complete);
      EXPECT_EQ(disk.writes, room + 1) << jobs;
    }
}

}  // namespace
}  // namespace meso
