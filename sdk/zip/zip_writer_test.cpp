// SPDX-License-Identifier: Apache-2.0
#include "meso/zip/zip_writer.hpp"

#include <gtest/gtest.h>
#include <unistd.h>
#include <zip.h>

#include <filesystem>

namespace meso {
namespace {

namespace fs = std::filesystem;

class ZipWriterTest : public testing::Test {
 protected:
  void TearDown() override { fs::remove(path_); }

  /// The two entries that both targets are given.
  static bool fill(ZipWriter& zip, const std::string& large) {
    return zip.add("stored", "as it is", ZipMethod::store) && zip.add("folder/large", large, ZipMethod::deflate) &&
           zip.close();
  }

  std::string path_ = (fs::temp_directory_path() / ("meso_zip_" + std::to_string(getpid()))).string();
  DiagnosticSink sink_;
  RunOptions run_;
};

TEST_F(ZipWriterTest, WritesWhatLibzipReads) {
  const std::string large(3'000'000, 'x');
  auto file = OutputFile::create(path_, ExistingFile::replace, sink_);
  ZipToFile target(*file);
  ZipWriter zip(target, run_);
  ASSERT_TRUE(fill(zip, large)) << zip.why();
  ASSERT_TRUE(file->commit(sink_));
  EXPECT_EQ(fs::file_size(path_), zip.size());
  EXPECT_LT(zip.size(), 10'000u);

  zip_t* back = zip_open(path_.c_str(), ZIP_RDONLY | ZIP_CHECKCONS, nullptr);
  ASSERT_NE(back, nullptr);
  std::string text(large.size(), '\0');
  zip_file_t* entry = zip_fopen(back, "folder/large", 0);
  EXPECT_EQ(zip_fread(entry, text.data(), text.size()), static_cast<zip_int64_t>(large.size()));
  EXPECT_EQ(text, large);
  zip_fclose(entry);
  zip_close(back);
}

TEST_F(ZipWriterTest, ASizeIsThatOfTheFile) {
  ZipSize nowhere;
  ZipWriter sized(nowhere, run_);
  ASSERT_TRUE(fill(sized, std::string(100'000, 'y')));
  auto file = OutputFile::create(path_, ExistingFile::replace, sink_);
  ZipToFile target(*file);
  ZipWriter zip(target, run_);
  ASSERT_TRUE(fill(zip, std::string(100'000, 'y')));
  EXPECT_EQ(sized.size(), zip.size());
}

TEST_F(ZipWriterTest, AFullTargetIsAFailure) {
  class Full final : public ZipTarget {
    [[nodiscard]] bool write_at(std::uint64_t offset, std::string_view bytes) override {
      return offset + bytes.size() < 1000;
    }
  } full;
  ZipWriter zip(full, run_);
  std::string noise(100'000, '\0');
  std::uint32_t state = 1;
  for (char& c : noise) c = static_cast<char>((state = state * 1664525 + 1013904223) >> 24);
  EXPECT_FALSE(fill(zip, noise));
  EXPECT_FALSE(zip.why().empty());
}

TEST_F(ZipWriterTest, StopsWhenItIsTold) {
  run_.cancelled = [] { return true; };
  ZipSize nowhere;
  ZipWriter zip(nowhere, run_);
  EXPECT_FALSE(fill(zip, std::string(10'000'000, 'z')));
}

}  // namespace
}  // namespace meso
