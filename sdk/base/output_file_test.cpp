// SPDX-License-Identifier: Apache-2.0
#include "meso/base/output_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "meso/base/unfinished_files.hpp"

namespace meso {
namespace {

namespace fs = std::filesystem;

class OutputFileTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("meso_output_file_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  static std::string content(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void make(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
  [[nodiscard]] std::ptrdiff_t files() const {
    return std::distance(fs::directory_iterator(folder_), fs::directory_iterator());
  }

  fs::path folder_;
  DiagnosticSink sink_;
};

TEST_F(OutputFileTest, AppearsOnlyAtCommit) {
  auto file = OutputFile::create(path("a"), ExistingFile::replace, sink_);
  ASSERT_TRUE(file);
  EXPECT_TRUE(file->write("one "));
  EXPECT_TRUE(file->write("two"));
  EXPECT_FALSE(fs::exists(path("a")));
  EXPECT_TRUE(fs::exists(file->temporary_path()));
  EXPECT_TRUE(file->commit(sink_));
  EXPECT_EQ(content(path("a")), "one two");
  EXPECT_EQ(files(), 1);
}

TEST_F(OutputFileTest, OverwritesInPlaceAndGoesOnAtItsEnd) {
  auto file = OutputFile::create(path("a"), ExistingFile::replace, sink_);
  ASSERT_TRUE(file);
  EXPECT_TRUE(file->write("count ??, ") && file->write_at(6, "42") && file->write("end") && file->commit(sink_));
  EXPECT_EQ(content(path("a")), "count 42, end");
}

TEST_F(OutputFileTest, LeavesNothingWithoutCommit) {
  make("a", "old");
  {
    auto file = OutputFile::create(path("a"), ExistingFile::replace, sink_);
    ASSERT_TRUE(file);
    EXPECT_TRUE(file->write("new"));
  }
  EXPECT_EQ(content(path("a")), "old");
  EXPECT_EQ(files(), 1);
}

TEST_F(OutputFileTest, KeepsPermissionsOfWhatItReplaces) {
  make("a", "old");
  fs::permissions(path("a"), fs::perms::owner_read | fs::perms::owner_write);
  auto file = OutputFile::create(path("a"), ExistingFile::replace, sink_);
  ASSERT_TRUE(file);
  EXPECT_TRUE(file->write("new") && file->commit(sink_));
  EXPECT_EQ(content(path("a")), "new");
  EXPECT_EQ(fs::status(path("a")).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(OutputFileTest, WritesThroughASymbolicLink) {
  make("real", "old");
  fs::create_symlink("real", path("link"));
  auto file = OutputFile::create(path("link"), ExistingFile::replace, sink_);
  ASSERT_TRUE(file);
  EXPECT_TRUE(file->write("new") && file->commit(sink_));
  EXPECT_EQ(content(path("real")), "new");
  EXPECT_TRUE(fs::is_symlink(path("link")));
}

TEST_F(OutputFileTest, RefusesToReplace) {
  make("a", "old");
  EXPECT_FALSE(OutputFile::create(path("a"), ExistingFile::refuse, sink_));
  ASSERT_EQ(sink_.error_count(), 1u);
  EXPECT_EQ(sink_.diagnostics()[0].code, Code::write_exists);
}

TEST_F(OutputFileTest, CanBeAskedBeforehand) {
  make("a", "old");
  EXPECT_TRUE(OutputFile::can_create(path("a"), ExistingFile::replace, sink_));
  EXPECT_TRUE(OutputFile::can_create(path("b"), ExistingFile::refuse, sink_));
  EXPECT_TRUE(OutputFile::can_create("/dev/null", ExistingFile::replace, sink_));
  EXPECT_EQ(sink_.error_count(), 0u);
  EXPECT_EQ(files(), 1);
  EXPECT_EQ(content(path("a")), "old");
  EXPECT_FALSE(OutputFile::can_create(path("a"), ExistingFile::refuse, sink_));
  EXPECT_FALSE(OutputFile::can_create(path("no/such/a"), ExistingFile::replace, sink_));
  ASSERT_EQ(sink_.error_count(), 2u);
  EXPECT_EQ(sink_.diagnostics()[0].code, Code::write_exists);
  EXPECT_EQ(sink_.diagnostics()[1].code, Code::write_failed);
}

TEST_F(OutputFileTest, RefusesAFileThatAppearedMeanwhile) {
  auto file = OutputFile::create(path("a"), ExistingFile::refuse, sink_);
  ASSERT_TRUE(file);
  make("a", "theirs");
  EXPECT_FALSE(file->commit(sink_));
  EXPECT_EQ(sink_.diagnostics().at(0).code, Code::write_exists);
  EXPECT_EQ(content(path("a")), "theirs");
  EXPECT_EQ(files(), 1);
}

TEST_F(OutputFileTest, ReportsAMissingFolder) {
  EXPECT_FALSE(OutputFile::create(path("no/such/a"), ExistingFile::replace, sink_));
  ASSERT_EQ(sink_.error_count(), 1u);
  EXPECT_EQ(sink_.diagnostics()[0].code, Code::write_failed);
}

// For the rest of its process nothing can be made: so in one of its own.
TEST_F(OutputFileTest, NothingIsLeftOrMadeWhereTheProcessEnds) {
  fs::create_directory(folder_ / "there");
  make("there/real", "old");
  fs::create_symlink("there/real", path("link"));
  const auto end = [&] {
    auto file = OutputFile::create(path("link"), ExistingFile::replace, sink_);
    const std::string folder = path("folder");
    const bool made = file && file->write("new") &&
                      make_unfinished(folder, [&] { return ::mkdir(folder.c_str(), 0777) == 0; }) &&
                      OutputFile::create(folder + "/b", ExistingFile::refuse, sink_)->commit(sink_);
    remove_unfinished();
    const bool later = OutputFile::create(path("c"), ExistingFile::replace, sink_) || file->commit(sink_);
    ::_exit(!made ? 1 : later ? 2 : 0);
  };
  EXPECT_EXIT(end(), testing::ExitedWithCode(0), "");
  EXPECT_EQ(content(path("there/real")), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "there"), fs::directory_iterator()), 1);
  EXPECT_EQ(files(), 2);
}

TEST_F(OutputFileTest, ReportsAFullDisk) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  auto file = OutputFile::create("/dev/full", ExistingFile::replace, sink_);
  ASSERT_TRUE(file);
  EXPECT_FALSE(file->write("x"));
  EXPECT_FALSE(file->commit(sink_));
  EXPECT_EQ(sink_.diagnostics().at(0).code, Code::write_failed);
  EXPECT_TRUE(fs::exists("/dev/full"));
}

}  // namespace
}  // namespace meso
