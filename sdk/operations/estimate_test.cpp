// SPDX-License-Identifier: Apache-2.0
#include "meso/operations/estimate.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "meso/base/byte_sink.hpp"
#include "meso/brep/triangles.hpp"
#include "meso/export_step/write_step.hpp"
#include "meso/export_stl/write_stl.hpp"

namespace meso::operations {
namespace {

class NullSink final : public ByteSink {
 public:
  [[nodiscard]] bool write(std::string_view) override { return true; }
};

struct Case {
  const char* document;
  std::vector<eval::Override> overrides;
};

/// A block of n^3 body-centred cells.
constexpr const char* block = R"(<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter">
  <parameters><parameter id="n" value="3"/></parameters>
  <macrostructures><macrostructure id="m"><csg><box dx="5*n" dy="5*n" dz="5*n"/></csg></macrostructure></macrostructures>
  <unitCells><unitCell id="u"><box dx="5" dy="5" dz="5"/><beams radius="0.5" nodeRadius="0.9">
    <node id="a" x="0" y="0" z="0"/><node id="b" x="5" y="0" z="0"/><node id="c" x="0" y="5" z="0"/>
    <node id="d" x="5" y="5" z="0"/><node id="e" x="0" y="0" z="5"/><node id="f" x="5" y="0" z="5"/>
    <node id="g" x="0" y="5" z="5"/><node id="h" x="5" y="5" z="5"/><node id="o" x="2.5" y="2.5" z="2.5"/>
    <beam from="a" to="o"/><beam from="b" to="o"/><beam from="c" to="o"/><beam from="d" to="o"/>
    <beam from="e" to="o"/><beam from="f" to="o"/><beam from="g" to="o"/><beam from="h" to="o"/></beams></unitCell></unitCells>
  <patterns><pattern id="p" unitCell="u"><loop index="i" axis="x" count="n" spacing="5"/>
    <loop index="j" axis="y" count="n" spacing="5"/><loop index="k" axis="z" count="n" spacing="5"/></pattern></patterns>
  <parts><part id="t" macrostructure="m"><apply pattern="p" operation="intersection"/></part></parts></meso>)";

std::filesystem::path document(std::string_view name) {
  if (name != "block") return std::filesystem::path(MESO_SOURCE_DIR) / "examples" / name;
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "estimate_block.meso";
  std::ofstream(file) << block;
  return file;
}

class EstimateOf : public testing::TestWithParam<Case> {};

// The truth is the whole job: the body built, its faces counted, its files written.
TEST_P(EstimateOf, IsRightWithinAFactorOfOneAndAHalf) {
  DiagnosticSink sink;
  const auto file = document(GetParam().document);
  const auto guess = estimate(file, {.overrides = GetParam().overrides}, sink);
  const auto made = make_body(file, {.overrides = GetParam().overrides, .mesh = true}, sink);
  ASSERT_TRUE(guess && made);
  const brep::Body& body = made->realisation.body;
  NullSink null;
  const StlCounts binary = write_stl(brep::triangles_of(body), StlFormat::binary, null);
  const StlCounts ascii = write_stl(brep::triangles_of(body), StlFormat::ascii, null);
  const auto expect_near = [](const char* what, std::uint64_t guessed, std::uint64_t truth) {
    const double ratio = static_cast<double>(guessed) / static_cast<double>(truth);
    EXPECT_LT(ratio, 1.5) << what << ' ' << guessed << " for " << truth;
    EXPECT_GT(ratio, 1 / 1.5) << what << ' ' << guessed << " for " << truth;
  };
  EXPECT_EQ(guess->placed, made->realisation.cells.placed);
  EXPECT_EQ(guess->kept, made->realisation.cells.kept);
  expect_near("faces", guess->faces, brep::measure(body).faces);
  expect_near("triangles", guess->triangles, binary.triangles);
  expect_near("STEP bytes", guess->step_bytes, write_step(body, {}, null).bytes);
  expect_near("STL bytes", guess->stl_bytes, binary.bytes);
  expect_near("ASCII STL bytes", guess->ascii_stl_bytes, ascii.bytes);
}

INSTANTIATE_TEST_SUITE_P(Examples, EstimateOf,
                         testing::Values(Case{"block", {}}, Case{"block", {{"n", "1"}}}, Case{"block", {{"n", "8"}}},
                                         Case{"ibeam/ibeam.meso", {{"pitch", "10mm"}}}, Case{"ibeam/ibeam.meso", {}},
                                         Case{"ibeam/ibeam-whd.meso", {}}, Case{"ibeam/ibeam-body.meso", {}},
                                         Case{"disk/disk.meso", {}}, Case{"disk/disk.meso", {{"rings", "12"}}},
                                         Case{"sphere/sphere.meso", {}},
                                         Case{"sphere/sphere.meso", {{"shells", "4"}, {"bands", "8"}}}));

// Nothing is built, so that no limit applies: a billion cells and more answer like a thousand.
TEST(Estimate, OfABillionCells) {
  DiagnosticSink sink;
  const auto aligned = estimate(document("block"), {.overrides = {{"n", "1000"}}}, sink);
  ASSERT_TRUE(aligned);
  EXPECT_EQ(aligned->kept, 1'000'000'000u);
  const auto sampled = estimate(document("disk/disk.meso"),
                                {.overrides = {{"rings", "1000"}, {"sectors", "3600"}, {"layers", "300"}}}, sink);
  ASSERT_TRUE(sampled);
  EXPECT_EQ(sampled->placed, 1'080'000'000u);
  EXPECT_EQ(sampled->kept, sampled->placed);
  EXPECT_EQ(sampled->faces, 6 * sampled->placed + 4);  // six of each sector, four of the disk
}

}  // namespace
}  // namespace meso::operations
