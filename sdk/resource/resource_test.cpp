// SPDX-License-Identifier: Apache-2.0
#include "meso/resource/resource.hpp"

#include <gtest/gtest.h>

#include <fstream>

namespace meso {
namespace {
namespace fs = std::filesystem;

class ResourceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) / "meso_resource_test";
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "sub");
    std::ofstream(folder_ / "sub" / "abc.txt") << "abc";
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path folder_;
};

TEST_F(ResourceTest, FindsFilesInsideTheFolder) {
  EXPECT_TRUE(resolve_href(folder_, "sub/abc.txt"));
  EXPECT_TRUE(resolve_href(folder_, "sub/../sub/abc.txt"));
  EXPECT_TRUE(resolve_href(folder_, "not-there.step"));
}

TEST_F(ResourceTest, RefusesToLeaveTheFolder) {
  for (const char* bad : {"", "/etc/passwd", "../x", "sub/../../x", "file:///etc/passwd", "http://x/y", "a\\b", "."}) {
    const auto found = resolve_href(folder_, bad);
    EXPECT_TRUE(!found || std::string_view(bad) == ".") << bad;
  }
}

TEST_F(ResourceTest, RefusesSymbolicLinksOutOfTheFolder) {
  fs::create_symlink("/etc", folder_ / "link");
  EXPECT_FALSE(resolve_href(folder_, "link/passwd"));
}

TEST_F(ResourceTest, Sha256OfTheStandardsExample) {  // FIPS 180-4: "abc"
  EXPECT_EQ(sha256_of_file(folder_ / "sub" / "abc.txt"),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_FALSE(sha256_of_file(folder_ / "missing"));
}

}  // namespace
}  // namespace meso
