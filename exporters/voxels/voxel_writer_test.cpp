// SPDX-License-Identifier: Apache-2.0
#include "meso/export_voxels/voxel_writer.hpp"

#include <gtest/gtest.h>

#include <cstring>

namespace meso {
namespace {

std::string written(VoxelFormat format) {
  StringSink bytes;
  const auto writer = make_voxel_writer(format, bytes);
  EXPECT_TRUE(writer->begin({.cells = {2, 3, 2}, .origin = {-1, 0, 5}, .spacing = {0.5, 0.25, 2}}));
  EXPECT_TRUE(writer->write_plane("abcdef") && writer->write_plane("ghijkl") && writer->finish());
  return bytes.text();
}

TEST(VoxelWriter, NrrdSaysWhereTheMiddleOfTheFirstCellIs) {
  EXPECT_EQ(written(VoxelFormat::nrrd), R"(NRRD0005
type: uint8
dimension: 3
sizes: 2 3 2
space dimension: 3
space units: "mm" "mm" "mm"
space directions: (0.5,0,0) (0,0.25,0) (0,0,2)
space origin: (-0.75,0.125,6)
centerings: cell cell cell
endian: little
encoding: raw
content: occupancy

abcdefghijkl)");
}

TEST(VoxelWriter, VtiHasItsBytesBehindTheirNumber) {
  const std::string bytes = written(VoxelFormat::vti);
  EXPECT_NE(bytes.find("WholeExtent=\"0 2 0 3 0 2\" Origin=\"-1 0 5\" Spacing=\"0.5 0.25 2\""), bytes.npos);
  const std::size_t data = bytes.find("encoding=\"raw\">\n_") + 17;
  std::uint64_t size = 0;
  std::memcpy(&size, bytes.data() + data, sizeof size);
  EXPECT_EQ(size, 12u);
  EXPECT_EQ(bytes.substr(data + 8, 13), "abcdefghijkl\n");
}

TEST(VoxelWriter, FormatIsToldByTheEnding) {
  EXPECT_EQ(voxel_format_of("a.b/c.NRRD"), VoxelFormat::nrrd);
  EXPECT_EQ(voxel_format_of("c.vti"), VoxelFormat::vti);
  EXPECT_FALSE(voxel_format_of("nrrd"));
  EXPECT_FALSE(voxel_format_of("c.vtu"));
}

}  // namespace
}  // namespace meso
