// SPDX-License-Identifier: Apache-2.0
#include "meso/package/package.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "meso/package/open_document.hpp"
#include "meso/package/referenced_files.hpp"

namespace meso {
namespace {
namespace fs = std::filesystem;

constexpr const char* document = R"(<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter">
  <macrostructures>
    <macrostructure id="a"><import href="bodies/a.stl"
      unit="millimeter"/></macrostructure>
    <macrostructure id="b"><import href="./bodies/../bodies/a.stl" unit="millimeter" sha256="SUM"/></macrostructure>
    <macrostructure id="c"><import href='b.step'/></macrostructure>
  </macrostructures>
</meso>
)";

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class PackageTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "in" / "bodies");
    std::ofstream(folder_ / "in" / "bodies" / "a.stl") << "solid a\nendsolid a\n";
    std::ofstream(folder_ / "in" / "b.step") << "ISO-10303-21;\n";
    write_document(sha256_of_bytes("solid a\nendsolid a\n"));
  }
  void TearDown() override { fs::remove_all(folder_); }
  void write_document(const std::string& sum) {
    std::string text = document;
    text.replace(text.find("SUM"), 3, sum);
    std::ofstream(folder_ / "in" / "beam.meso") << text;
  }
  std::string first_fault() const { return sink_.diagnostics().empty() ? "" : render(sink_.diagnostics()[0]); }

  fs::path folder_ = fs::path(testing::TempDir()) / "meso_package_test";
  fs::path in_ = folder_ / "in" / "beam.meso", out_ = folder_ / "beam.mesoz";
  DiagnosticSink sink_;
};

TEST_F(PackageTest, HoldsEveryFileOnceAndItsSum) {
  const auto report = pack(in_, out_, {.thumbnail = "png"}, sink_);
  ASSERT_TRUE(report) << first_fault();
  EXPECT_EQ(report->files, 3U);
  EXPECT_EQ(report->bytes, fs::file_size(out_));
  const auto package = Package::read(out_, {}, sink_);
  ASSERT_TRUE(package) << first_fault();
  std::vector<std::string> names;
  for (const auto& [name, bytes] : package->entries()) names.push_back(name);
  EXPECT_THAT(names, testing::ElementsAre("b.step", "beam.meso", "bodies/a.stl", "manifest.sha256", "thumbnail.png"));
  EXPECT_EQ(package->document(), "beam.meso");
  EXPECT_THAT(*package->entries().at("manifest.sha256"),
              testing::HasSubstr(sha256_of_bytes("ISO-10303-21;\n") + "  b.step\n"));
  EXPECT_EQ(*package->find("bodies//a.stl")->memory(), "solid a\nendsolid a\n");
  EXPECT_FALSE(package->find("nothing.step")->exists());
  EXPECT_FALSE(package->find("../beam.step"));
}

TEST_F(PackageTest, StatesTheSumsThatTheDocumentLeavesOut) {
  ASSERT_TRUE(pack(in_, out_, {}, sink_)) << first_fault();
  const std::string packed = *Package::read(out_, {}, sink_)->entries().at("beam.meso");
  // Nothing but the two attributes has come in.
  std::string expected = bytes_of(in_);
  const std::string a = " sha256=\"" + sha256_of_bytes("solid a\nendsolid a\n") + "\"",
                    b = " sha256=\"" + sha256_of_bytes("ISO-10303-21;\n") + "\"";
  expected.insert(expected.find("a.stl\"\n") + 6, a);
  expected.insert(expected.find("b.step'") + 7, b);
  EXPECT_EQ(packed, expected);
  const auto checked = open_checked_document(out_, {}, sink_);
  ASSERT_TRUE(checked) << first_fault();
  for (const ReferencedFile& file : referenced_files(*checked)) {
    for (const ReferencedFile::Use& use : file.uses) EXPECT_TRUE(use.has_sha256) << file.name;
  }
  // A package made of what came out of one is that package again.
  ASSERT_TRUE(unpack(out_, folder_ / "again", ExistingFile::replace, {}, sink_)) << first_fault();
  ASSERT_TRUE(pack(folder_ / "again" / "beam.meso", folder_ / "again.mesoz", {}, sink_)) << first_fault();
  EXPECT_EQ(bytes_of(folder_ / "again.mesoz"), bytes_of(out_));
}

TEST_F(PackageTest, EqualFilesGiveEqualBytesWheneverTheyWereWritten) {
  ASSERT_TRUE(pack(in_, out_, {}, sink_));
  for (const char* name : {"beam.meso", "b.step"})
    fs::last_write_time(folder_ / "in" / name, fs::file_time_type::clock::now() - std::chrono::hours(99));
  fs::permissions(folder_ / "in" / "b.step", fs::perms::owner_all);
  ASSERT_TRUE(pack(in_, folder_ / "second.mesoz", {}, sink_));
  EXPECT_EQ(bytes_of(folder_ / "second.mesoz"), bytes_of(out_));
  const auto checked = open_checked_document(in_, {}, sink_);
  ASSERT_TRUE(checked);
  EXPECT_EQ(packed_size(*checked, {}, sink_)->bytes, fs::file_size(out_));
}

TEST_F(PackageTest, AStatedSumIsChecked) {
  write_document(std::string(64, '0'));
  EXPECT_FALSE(pack(in_, out_, {}, sink_));
  EXPECT_THAT(first_fault(), testing::HasSubstr("beam.meso:5:"));
  EXPECT_THAT(first_fault(), testing::HasSubstr("IMPORT_CHANGED"));
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(PackageTest, NamesOfItsOwnFilesCannotBePacked) {
  std::ofstream(folder_ / "in" / "thumbnail.png") << "picture";
  std::ofstream(in_) << R"(<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter"><vectorFields>
    <vectorField id="f"><structure records="1"><component name="s"/><points/></structure>
    <external format="raw" href="thumbnail.png"/><interpolation method="records"/></vectorField></vectorFields></meso>)";
  EXPECT_FALSE(pack(in_, out_, {}, sink_));
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(PackageTest, UnpackingMakesAFolderThatChecksItself) {
  ASSERT_TRUE(pack(in_, out_, {}, sink_));
  const auto report = unpack(out_, folder_ / "out/", ExistingFile::replace, {}, sink_);
  ASSERT_TRUE(report) << first_fault();
  EXPECT_EQ(report->files, 4U);
  EXPECT_EQ(bytes_of(folder_ / "out" / "bodies" / "a.stl"), "solid a\nendsolid a\n");
  EXPECT_EQ(std::system(("cd '" + (folder_ / "out").string() + "' && sha256sum --quiet -c manifest.sha256").c_str()),
            0);
}

TEST_F(PackageTest, NothingIsUnpackedOverSomething) {
  ASSERT_TRUE(pack(in_, out_, {}, sink_));
  fs::create_directories(folder_ / "empty");
  EXPECT_FALSE(unpack(out_, folder_ / "empty", ExistingFile::refuse, {}, sink_));
  EXPECT_TRUE(unpack(out_, folder_ / "empty", ExistingFile::replace, {}, sink_));
  EXPECT_FALSE(unpack(out_, folder_ / "empty", ExistingFile::replace, {}, sink_));
  EXPECT_FALSE(unpack(out_, folder_ / "no" / "folder", ExistingFile::replace, {}, sink_));
  ASSERT_EQ(sink_.diagnostics().size(), 3U);
  EXPECT_EQ(sink_.diagnostics()[0].code, Code::write_exists);
  EXPECT_EQ(sink_.diagnostics()[1].code, Code::write_exists);
  EXPECT_EQ(sink_.diagnostics()[2].code, Code::write_failed);
}

TEST_F(PackageTest, AStoppedRunWritesNothing) {
  const RunOptions stopped{.cancelled = [] { return true; }};
  EXPECT_FALSE(pack(in_, out_, {.run = stopped}, sink_));
  EXPECT_FALSE(fs::exists(out_));
  ASSERT_TRUE(pack(in_, out_, {}, sink_));
  EXPECT_FALSE(unpack(out_, folder_ / "out", ExistingFile::replace, stopped, sink_));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  ASSERT_EQ(sink_.diagnostics().size(), 2U);
  EXPECT_EQ(sink_.diagnostics()[0].code, Code::cancelled);
  EXPECT_EQ(sink_.diagnostics()[1].code, Code::cancelled);
}

}  // namespace
}  // namespace meso
