// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/voxels.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <numbers>
#include <string>
#include <vector>

#include "meso/implicit/compile.hpp"
#include "meso/implicit/field.hpp"

namespace meso::implicit {
namespace {

class Memory final : public VoxelSink {
 public:
  [[nodiscard]] bool begin(const VoxelArray& a) override {
    array = a;
    return true;
  }
  [[nodiscard]] bool write_plane(std::string_view plane) override {
    EXPECT_EQ(plane.size(), array.plane_bytes());
    bytes += plane;
    return planes_until_failure-- > 0;
  }
  [[nodiscard]] bool finish() override { return true; }

  [[nodiscard]] float real(std::size_t i) const {
    float v;
    std::memcpy(&v, bytes.data() + 4 * i, 4);
    return v;
  }
  [[nodiscard]] unsigned whole(std::size_t i) const { return static_cast<unsigned char>(bytes[i]); }

  VoxelArray array;
  std::string bytes;
  int planes_until_failure = 1 << 20;
};

bool sample(const Field& field, const VoxelGrid& voxels, VoxelValue value, Memory& out, const RunOptions& run = {},
            DiagnosticSink* sink = nullptr) {
  const auto source = compile(field.term(), voxels.samples());
  DiagnosticSink own;
  return sample_voxels(*source, voxels, value, out, run, sink != nullptr ? *sink : own);
}

const VoxelGrid around_ball{.box = {{-1.1, -1.2, -1.3}, {1.1, 1.2, 1.3}}, .cells = {22, 24, 26}};

Vec3 middle(const VoxelArray& a, std::size_t i) {
  const std::size_t x = i % a.cells[0], y = i / a.cells[0] % a.cells[1], z = i / a.cells[0] / a.cells[1];
  return {a.origin.x + (double(x) + 0.5) * a.spacing.x, a.origin.y + (double(y) + 0.5) * a.spacing.y,
          a.origin.z + (double(z) + 0.5) * a.spacing.z};
}

TEST(Voxels, OccupancyIsTheBallAtMiddlesOfCells) {
  Memory out;
  ASSERT_TRUE(sample(Field::ball(1), around_ball, VoxelValue::occupancy, out));
  ASSERT_EQ(out.bytes.size(), 22u * 24 * 26);
  for (std::size_t i = 0; i < out.bytes.size(); ++i)
    ASSERT_EQ(out.whole(i), norm(middle(out.array, i)) < 1 ? 1u : 0u) << i;
}

TEST(Voxels, DistanceIsTheFieldsValue) {
  Memory out;
  ASSERT_TRUE(sample(Field::ball(1), around_ball, VoxelValue::distance, out));
  EXPECT_EQ(out.array.type, VoxelType::float32);
  for (std::size_t i = 0; i < out.bytes.size() / 4; ++i)
    ASSERT_NEAR(out.real(i), norm(middle(out.array, i)) - 1, 1e-6) << i;
}

TEST(Voxels, DensityAddsUpToTheVolume) {
  VoxelGrid fine = around_ball;
  fine.subsamples = {4, 4, 4};
  Memory out;
  ASSERT_TRUE(sample(Field::ball(1), fine, VoxelValue::density, out));
  double sum = 0;
  for (std::size_t i = 0; i < out.bytes.size() / 4; ++i) {
    const float d = out.real(i);
    ASSERT_TRUE(d >= 0 && d <= 1);
    const double r = norm(middle(out.array, i));
    ASSERT_GE(d, r < 0.9 ? 1 : 0);
    ASSERT_LE(d, r > 1.1 ? 0 : 1);
    sum += d * 1e-3;
  }
  EXPECT_NEAR(sum, 4 * std::numbers::pi / 3, 0.01);
}

TEST(Voxels, GreyIsTheShareOf255) {
  // A half-space over a fourth of each cell of the first column.
  const VoxelGrid voxels{.box = {{0, 0, 0}, {2, 1, 1}}, .cells = {2, 1, 1}, .subsamples = {4, 1, 1}};
  Memory out;
  ASSERT_TRUE(sample(Field::half_space({1, 0, 0}, 0.25), voxels, VoxelValue::grey, out));
  EXPECT_EQ(out.whole(0), 64u);
  EXPECT_EQ(out.whole(1), 0u);
}

TEST(Voxels, OneVoxelHasOneSample) {
  const VoxelGrid one{.box = {{0, 0, 0}, {1, 1, 1}}};
  EXPECT_EQ(one.samples().node(0, 0, 0), (Vec3{0.5, 0.5, 0.5}));
  Memory out;
  ASSERT_TRUE(sample(Field::ball(0.9), one, VoxelValue::occupancy, out));
  EXPECT_EQ(out.bytes, std::string(1, '\1'));
}

TEST(Voxels, EqualBytesForAnyNumberOfThreads) {
  Memory one, three;
  VoxelGrid voxels = around_ball;
  voxels.subsamples = {2, 2, 2};
  ASSERT_TRUE(sample(Field::ball(1), voxels, VoxelValue::grey, one, {.jobs = 1}));
  ASSERT_TRUE(sample(Field::ball(1), voxels, VoxelValue::grey, three, {.jobs = 3}));
  EXPECT_EQ(one.bytes, three.bytes);
}

TEST(Voxels, BudgetsStopsAndFailedSinksEndTheWork) {
  Memory out;
  DiagnosticSink sink;
  EXPECT_FALSE(sample(Field::ball(1), around_ball, VoxelValue::occupancy, out, {.max_memory_bytes = 1000}, &sink));
  EXPECT_FALSE(
      sample(Field::ball(1), around_ball, VoxelValue::occupancy, out, {.cancelled = [] { return true; }}, &sink));
  ASSERT_EQ(sink.error_count(), 2u);
  EXPECT_EQ(sink.diagnostics()[0].code, Code::limit_grid_memory);
  EXPECT_EQ(sink.diagnostics()[1].code, Code::cancelled);
  Memory full;
  full.planes_until_failure = 3;
  EXPECT_FALSE(sample(Field::ball(1), around_ball, VoxelValue::occupancy, full, {}, &sink));
  EXPECT_EQ(sink.error_count(), 2u);  // the sink's owner reports
}

}  // namespace
}  // namespace meso::implicit
