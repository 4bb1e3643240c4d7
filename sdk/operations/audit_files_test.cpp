// SPDX-License-Identifier: Apache-2.0
#include "audit_files.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "meso/export_step/write_step.hpp"
#include "meso/operations/convert.hpp"

namespace meso::operations {
namespace {

class FileSink final : public ByteSink {
 public:
  explicit FileSink(const std::filesystem::path& file) : out_(file, std::ios::binary) {}
  [[nodiscard]] bool write(std::string_view bytes) override {
    return static_cast<bool>(out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size())));
  }

 private:
  std::ofstream out_;
};

/// The audit of a STEP file of a block, y from -5 to 5, with a bubble of radius 1 that was moved by `y`.
std::optional<VerifyReport> audit_of_moved_bubble(double y) {
  const auto folder = std::filesystem::path(::testing::TempDir());
  const auto document = folder / "bubble.meso", step = folder / "bubble.step";
  std::ofstream(document) << "<meso xmlns='urn:meso-format:1.0' version='1.0' unit='millimeter'><macrostructures>"
                             "<macrostructure id='m'><csg><box x='-10' y='-5' z='-5' dx='20' dy='10' dz='10'/></csg>"
                             "</macrostructure></macrostructures><unitCells><unitCell id='u'><csg><sphere radius='1'/>"
                             "</csg></unitCell></unitCells><patterns><pattern id='c' unitCell='u'><loop index='i' "
                             "axis='x' count='1' spacing='1'/></pattern></patterns><parts><part id='p' "
                             "macrostructure='m'><apply pattern='c' operation='difference'/></part></parts></meso>";
  DiagnosticSink sink;
  auto made = make_body(document, {.part = "p"}, sink);
  if (!made || made->realisation.body.solids.at(0).voids.size() != 1) return {};
  made->realisation.body.solids[0].voids[0].placement.translation.y += y;
  {
    FileSink out(step);
    (void)write_step(made->realisation.body, {}, out);
  }
  auto report = audit_step(step, false, {}, sink);
  std::filesystem::remove(document);
  std::filesystem::remove(step);
  return report;
}

std::vector<std::string> failures(const VerifyReport& report) {
  std::vector<std::string> names;
  for (const Check& c : report.checks)
    if (!c.passed) names.push_back(c.what);
  return names;
}

TEST(AuditStep, ABubbleWithin) {
  const auto report = audit_of_moved_bubble(3.9);
  ASSERT_TRUE(report);
  EXPECT_EQ(failures(*report), std::vector<std::string>{});
  EXPECT_TRUE(std::ranges::any_of(report->checks, [](const Check& c) { return c.what == "self-contacts"; }));
}

// Closed, of positive volume, every edge used twice; and yet the shell of the bubble goes through that of the block.
// (Where its middle is outside, the reader makes two solids of them.)
TEST(AuditStep, ABubbleThatComesOut) {
  for (const double y : {4.2, 4.5, 4.8}) {
    const auto report = audit_of_moved_bubble(y);
    ASSERT_TRUE(report);
    EXPECT_EQ(failures(*report), std::vector<std::string>{"self-contacts"}) << y;
  }
}

}  // namespace
}  // namespace meso::operations
