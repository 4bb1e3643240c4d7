// SPDX-License-Identifier: Apache-2.0
#include "meso/export_slices/slice_files.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include <vector>

namespace meso {
namespace {

TEST(SliceSvg, HoldsLoopsInMillimetresUpward) {
  StringSink file;
  const Slice slice{.height = 0.5, .loops = {{{0, 0}, {1, 0}, {1, 1.5}}, {{0.25, 0.25}, {0.5, 0.5}, {0.5, 0.25}}}};
  ASSERT_TRUE(write_slice_svg(slice, {.min = {-1, 0}, .max = {1, 2}}, file));
  EXPECT_EQ(file.text(),
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"2mm\" height=\"2mm\" viewBox=\"-1 -2 2 2\">\n"
            "<desc>height 0.5 mm</desc>\n<path fill-rule=\"evenodd\" d=\"M0 0L1 0L1 -1.5Z\n"
            "M0.25 -0.25L0.5 -0.5L0.5 -0.25Z\n\"/>\n</svg>\n");
}

TEST(PngStack, HasOnePictureForEachPlaneWithTheSecondAxisUpward) {
  std::vector<std::string> files;
  PngStack stack([&](std::uint32_t plane, std::string_view bytes) {
    EXPECT_EQ(plane, files.size());
    files.emplace_back(bytes);
    return true;
  });
  ASSERT_TRUE(stack.begin({.cells = {3, 2, 2}, .spacing = {0.1, 0.1, 1}}));
  ASSERT_TRUE(stack.write_plane("abcdef") && stack.write_plane("ghijkl") && stack.finish());
  ASSERT_EQ(files.size(), 2u);
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_memory(&image, files[1].data(), files[1].size()));
  image.format = PNG_FORMAT_GRAY;
  std::string pixels(6, '\0');
  ASSERT_TRUE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr));
  EXPECT_EQ(image.width, 3u);
  EXPECT_EQ(pixels, "jklghi");
}

TEST(PngStack, StopsWhereAFileFails) {
  PngStack stack([](std::uint32_t, std::string_view) { return false; });
  ASSERT_TRUE(stack.begin({.cells = {1, 1, 1}, .spacing = {1, 1, 1}}));
  EXPECT_FALSE(stack.write_plane("a"));
}

}  // namespace
}  // namespace meso
