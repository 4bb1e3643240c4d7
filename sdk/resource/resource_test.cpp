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
  const auto folder = resources_in_folder(folder_);
  ASSERT_TRUE(folder->find("sub/abc.txt"));
  EXPECT_TRUE(folder->find("sub/abc.txt")->exists());
  EXPECT_EQ(folder->find("sub/../sub/abc.txt")->name(), folder->find("sub/abc.txt")->name());
  ASSERT_TRUE(folder->find("not-there.step"));
  EXPECT_FALSE(folder->find("not-there.step")->exists());
  EXPECT_FALSE(folder->find("sub")->exists());
}

TEST_F(ResourceTest, RefusesToLeaveTheFolder) {
  for (const char* bad : {"", "/etc/passwd", "../x", "sub/../../x", "file:///etc/passwd", "http://x/y", "a\\b", "."}) {
    EXPECT_FALSE(normalized_href(bad) && std::string_view(bad) != ".") << bad;
    const auto found = resources_in_folder(folder_)->find(bad);
    EXPECT_TRUE(!found || std::string_view(bad) == ".") << bad;
  }
}

TEST_F(ResourceTest, RefusesSymbolicLinksOutOfTheFolder) {
  fs::create_symlink("/etc", folder_ / "link");
  EXPECT_FALSE(resources_in_folder(folder_)->find("link/passwd"));
}

TEST_F(ResourceTest, Sha256OfTheStandardsExample) {  // FIPS 180-4: "abc"
  const std::string expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
  EXPECT_EQ(sha256_of(folder_ / "sub" / "abc.txt"), expected);
  EXPECT_EQ(sha256_of(Resource("p.mesoz/abc.txt", std::make_shared<const std::string>("abc"))), expected);
  EXPECT_FALSE(sha256_of(folder_ / "missing"));
}

TEST_F(ResourceTest, BytesOfAFileAndOfMemoryReadAlike) {
  std::string error;
  const auto file = ResourceBytes::open(folder_ / "sub" / "abc.txt", error);
  const auto memory = ResourceBytes::open({"p.mesoz/abc.txt", std::make_shared<const std::string>("abc")}, error);
  ASSERT_TRUE(file && memory) << error;
  EXPECT_EQ(file->view(), "abc");
  EXPECT_EQ(memory->view(), "abc");
  EXPECT_FALSE(ResourceBytes::open(folder_, error));
  EXPECT_EQ(error, "it is no regular file");
}

TEST(NormalizedHref, IsTheOneNameInTheFolder) {
  EXPECT_EQ(normalized_href("./a//b/../c.step"), "a/c.step");
  EXPECT_EQ(normalized_href("a/../../c.step"), std::nullopt);
}

}  // namespace
}  // namespace meso
