// SPDX-License-Identifier: Apache-2.0
// Packages that somebody made to do harm, or that a copy has damaged: one diagnostic each, and nothing on disk.
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <zip.h>

#include <fstream>

#include "meso/package/package.hpp"

namespace meso {
namespace {
namespace fs = std::filesystem;

constexpr std::string_view smallest = R"(<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter"/>)";

struct Entry {
  std::string name;
  std::string bytes;
  zip_uint32_t mode = S_IFREG | 0644;
  const char* password = nullptr;
  int method = ZIP_CM_DEFLATE;
  bool is_listed = true;  ///< in the manifest
};

class HostilePackage : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// As good a package as can be made around these entries.
  void write(std::vector<Entry> entries, bool with_document = true, const std::string& more_manifest = {}) {
    if (with_document) entries.insert(entries.begin(), {"a.meso", std::string(smallest)});
    std::string manifest;
    for (const Entry& e : entries)
      if (e.is_listed) manifest += sha256_of_bytes(e.bytes) + "  " + e.name + "\n";
    entries.push_back({"manifest.sha256", manifest + more_manifest});
    entries.insert(entries.begin(), {"mimetype", "application/vnd.meso+zip", S_IFREG | 0644, nullptr, ZIP_CM_STORE});
    write_zip(entries);
  }
  void write_zip(const std::vector<Entry>& entries) {
    zip_t* zip = zip_open(file_.c_str(), ZIP_CREATE | ZIP_TRUNCATE, nullptr);
    ASSERT_NE(zip, nullptr);
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const Entry& e = entries[i];
      // The library refuses a second entry of one name; a name of the same length is patched in below.
      zip_file_add(zip, e.name.c_str(), zip_source_buffer(zip, e.bytes.data(), e.bytes.size(), 0), ZIP_FL_ENC_RAW);
      zip_set_file_compression(zip, i, e.method, 0);
      zip_file_set_external_attributes(zip, i, 0, ZIP_OPSYS_UNIX, e.mode << 16);
      if (e.password != nullptr) zip_file_set_encryption(zip, i, ZIP_EM_AES_256, e.password);
    }
    ASSERT_EQ(zip_close(zip), 0);
  }
  std::string bytes() const {
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void write_bytes(const std::string& bytes) const { std::ofstream(file_, std::ios::binary) << bytes; }
  static void replace_all(std::string& text, std::string_view from, std::string_view to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
      text.replace(at, from.size(), to);
  }

  /// The one fault of reading it; unpacking says the same and leaves nothing.
  std::string fault(const RunOptions& run = {}) const {
    DiagnosticSink sink, again;
    EXPECT_FALSE(Package::read(file_, run, sink));
    EXPECT_FALSE(unpack(file_, folder_ / "out", ExistingFile::replace, run, again));
    EXPECT_EQ(sink.diagnostics(), again.diagnostics());
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1) << "something was written";
    EXPECT_EQ(sink.diagnostics().size(), 1U);
    return sink.diagnostics().empty() ? "" : render(sink.diagnostics()[0]);
  }

  fs::path folder_ = fs::path(testing::TempDir()) / "meso_hostile_package", file_ = folder_ / "a.mesoz";
};

TEST_F(HostilePackage, TheOneTheyAreVariantsOfIsRead) {
  write({{"b.step", "x"}});
  DiagnosticSink sink;
  EXPECT_TRUE(Package::read(file_, {}, sink)) << render(sink.diagnostics().at(0));
}

TEST_F(HostilePackage, NamesThatAreNoFilesOfAFolder) {
  const std::pair<const char*, const char*> bad[]{{"/etc/passwd", "absolute"},
                                                  {"../up.step", "leads out"},
                                                  {"a/../../up.step", "leads out"},
                                                  {"a\\b.step", "backslash"},
                                                  {"c:/x.step", "colon"},
                                                  {"a//b.step", "shortest form"},
                                                  {"./b.step", "shortest form"},
                                                  {"folder/", "folder"},
                                                  {"b\x01.step", "control character"},
                                                  {"b\xff.step", "not UTF-8"},
                                                  {"b\xc0\xaf.step", "not UTF-8"},
                                                  {"A.MESO", "another entry"},
                                                  {"a.meso/b.step", "one of its folders"},
                                                  {"x/../b.step", "leads out"}};
  for (const auto& [name, why] : bad) {
    write({{name, "x"}});
    EXPECT_THAT(fault(), testing::AllOf(testing::HasSubstr("PACKAGE_ENTRY"), testing::HasSubstr(why))) << name;
  }
}

TEST_F(HostilePackage, LongNames) {
  std::string steps;
  while (steps.size() < 1022) steps += "a/";
  DiagnosticSink sink;
  write({{steps + "bc", "x"}});
  EXPECT_TRUE(Package::read(file_, {}, sink));
  write({{steps + "bcd", "x"}});
  EXPECT_THAT(fault(), testing::HasSubstr("its name is too long"));
  write({{std::string(60'000, 'b'), "x"}});
  EXPECT_LT(fault().size(), 2000U);
  // A name and another's folder, whichever comes first.
  write({{"x-y", "x"}, {"x/b", "x"}, {"X", "x"}});
  EXPECT_THAT(fault(), testing::HasSubstr("other entries have this name as their folder"));
}

TEST_F(HostilePackage, ReadingTheDirectoryStops) {
  write({{"folder/", "x"}});
  RunOptions run;
  run.cancelled = [] { return true; };
  EXPECT_THAT(fault(run), testing::HasSubstr("CANCELLED"));
}

TEST_F(HostilePackage, TwoEntriesOfOneName) {
  write({{"b.step", "x"}, {"c.step", "x"}});
  std::string patched = bytes();
  replace_all(patched, "c.step", "b.step");
  write_bytes(patched);
  EXPECT_THAT(fault(), testing::HasSubstr("two of its entries have one name"));
}

TEST_F(HostilePackage, LinksAndEncryptedEntries) {
  write({{"b.step", "/etc/passwd", S_IFLNK | 0777}});
  EXPECT_THAT(fault(), testing::HasSubstr("it is a link"));
  write({{"b.step", "x", S_IFREG | 0644, "secret"}});
  EXPECT_THAT(fault(), testing::HasSubstr("it is encrypted"));
  if (zip_compression_method_supported(ZIP_CM_BZIP2, 1) != 0) {
    write({{"b.step", std::string(999, 'x'), S_IFREG | 0644, nullptr, ZIP_CM_BZIP2}});
    EXPECT_THAT(fault(), testing::HasSubstr("another method than deflate"));
  }
}

TEST_F(HostilePackage, ABombIsRefusedBeforeItIsInflated) {
  write({{"b.step", std::string(50'000'000, '\0')}});
  EXPECT_LT(fs::file_size(file_), 100'000U);
  EXPECT_THAT(fault({.max_memory_bytes = 1 << 20}), testing::HasSubstr("PACKAGE_TOO_LARGE"));
}

TEST_F(HostilePackage, ABombThatStatesASmallSizeIsRefused) {
  constexpr std::uint32_t true_size = 50'000'000, stated = 1000;
  write({{"b.step", std::string(true_size, '\0')}});
  std::string patched = bytes();
  replace_all(patched, {reinterpret_cast<const char*>(&true_size), 4}, {reinterpret_cast<const char*>(&stated), 4});
  write_bytes(patched);
  EXPECT_THAT(fault({.max_memory_bytes = 1 << 20}), testing::HasSubstr("PACKAGE_UNREADABLE"));
}

TEST_F(HostilePackage, DamagedBytes) {
  write({{"b.step", "0123456789", S_IFREG | 0644, nullptr, ZIP_CM_STORE}});
  const std::string whole = bytes();
  std::string flipped = whole;
  replace_all(flipped, "0123456789", "0123456780");
  write_bytes(flipped);
  EXPECT_THAT(fault(), testing::AllOf(testing::HasSubstr("PACKAGE_UNREADABLE"), testing::HasSubstr("CRC")));
  for (const std::size_t kept : {std::size_t{0}, std::size_t{10}, whole.size() / 2, whole.size() - 1}) {
    write_bytes(whole.substr(0, kept));
    EXPECT_THAT(fault(), testing::HasSubstr("PACKAGE_UNREADABLE")) << kept;
  }
}

TEST_F(HostilePackage, ManifestsThatDisagree) {
  write({{"b.step", "x", S_IFREG | 0644, nullptr, ZIP_CM_DEFLATE, false}});
  EXPECT_THAT(fault(), testing::HasSubstr("the manifest does not list it"));
  write({}, true, std::string(64, '0') + "  gone.step\n");
  EXPECT_THAT(fault(), testing::HasSubstr("has no 'gone.step'"));
  write({{"b.step", "x", S_IFREG | 0644, nullptr, ZIP_CM_DEFLATE, false}}, true, std::string(64, '0') + "  b.step\n");
  EXPECT_THAT(fault(), testing::HasSubstr("PACKAGE_CHANGED"));
  for (const char* line : {"b.step\n", "0  b.step\n", "\n"}) {
    write({{"b.step", "x"}}, true, line);
    EXPECT_THAT(fault(), testing::HasSubstr("line 3 is not a sum"));
  }
  write({{"b.step", "x"}}, true, sha256_of_bytes("x") + "  b.step\n");
  EXPECT_THAT(fault(), testing::HasSubstr("is not a sum, two spaces and a new name"));
}

TEST_F(HostilePackage, WhatIsMissing) {
  write({}, false);
  EXPECT_THAT(fault(), testing::HasSubstr("has no document"));
  write({{"b.meso", std::string(smallest)}});
  EXPECT_THAT(fault(), testing::HasSubstr("'a.meso' is the document already"));
  const Entry type{"mimetype", "application/vnd.meso+zip", S_IFREG | 0644, nullptr, ZIP_CM_STORE};
  write_zip({type, {"a.meso", std::string(smallest)}});
  EXPECT_THAT(fault(), testing::HasSubstr("has no manifest.sha256"));
  write_zip({{"a.meso", std::string(smallest)}, type});
  EXPECT_THAT(fault(), testing::HasSubstr("has no stored 'mimetype' in front"));
  write_zip({{"mimetype", "application/epub+zip", S_IFREG | 0644, nullptr, ZIP_CM_STORE}});
  EXPECT_THAT(fault(), testing::HasSubstr("it does not say application/vnd.meso+zip"));
}

TEST_F(HostilePackage, AFileThatIsNone) {
  write_bytes(std::string(smallest));
  EXPECT_THAT(fault(), testing::HasSubstr("it is no ZIP file"));
  DiagnosticSink sink;
  EXPECT_FALSE(Package::read(folder_ / "nothing.mesoz", {}, sink));
  EXPECT_FALSE(Package::read(folder_, {}, sink));
  EXPECT_EQ(sink.diagnostics().at(0).code, Code::file_not_found);
  EXPECT_EQ(sink.diagnostics().at(1).code, Code::file_not_found);
}

}  // namespace
}  // namespace meso
