// SPDX-License-Identifier: Apache-2.0
// The files were written by h5py (make_fixtures.py): another writer than ours.
#include "meso/import_field_hdf5/read_hdf5.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <thread>

namespace meso {
namespace {

std::string fixture(const std::string& name) {
  return std::string(MESO_SOURCE_DIR) + "/importers/field_hdf5/fixtures/" + name;
}
std::string bytes_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
std::string fault_of(const std::string& file, const std::string& path, const RunOptions& run = {}) {
  DiagnosticSink sink;
  EXPECT_FALSE(read_field_hdf5(file, path, run, sink));
  EXPECT_EQ(sink.diagnostics().size(), 1U);
  return sink.diagnostics().empty() ? "" : render(sink.diagnostics()[0]);
}

// value(r, c) = r + c / 8, in every data set.
class Hdf5 : public testing::TestWithParam<const char*> {};
TEST_P(Hdf5, ReadsEveryLayoutAndType) {
  DiagnosticSink sink;
  const auto table = read_field_hdf5(fixture("layouts.h5"), GetParam(), {}, sink);
  ASSERT_TRUE(table) << render(sink.diagnostics().at(0));
  ASSERT_EQ(table->records.rows(), 100U);
  ASSERT_EQ(table->records.columns(), 3U);
  EXPECT_TRUE(table->columns.empty());
  for (std::size_t r = 0; r < 100; ++r)
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_EQ(table->records(r, c), static_cast<double>(r) + static_cast<double>(c) / 8);
}
INSTANTIATE_TEST_SUITE_P(Layouts, Hdf5,
                         testing::Values("/contiguous", "/chunked", "/float", "/big", "/group/first,/group/second"));

TEST(Hdf5Names, ComeFromAttributesAndGroups) {
  DiagnosticSink sink;
  const auto named = read_field_hdf5(fixture("layouts.h5"), "/named", {}, sink);
  ASSERT_TRUE(named);
  EXPECT_EQ(named->columns.at(1).name, "syy");
  EXPECT_EQ(named->columns.at(1).unit, "MPa");
  const auto group = read_field_hdf5(fixture("layouts.h5"), "/group", {}, sink);
  ASSERT_TRUE(group);
  ASSERT_EQ(group->columns.size(), 3U);
  EXPECT_EQ(group->columns[0].name, "first_1");
  EXPECT_EQ(group->columns[2].name, "second");
  const auto integers = read_field_hdf5_integers(fixture("layouts.h5"), "/cells", {}, sink);
  ASSERT_TRUE(integers);
  EXPECT_THAT(*integers, testing::ElementsAre(0, 1, 2, 3, 1, 2, 3, 4));
}

TEST(Hdf5Names, OurFilesComeBack) {
  fields::Table table;
  table.columns = {{"x", "mm"}, {"stress", "MPa"}};
  table.records = fields::Records::of({1, 2, 0.1, 4, 5, -6}, 2);
  const std::string file = testing::TempDir() + "written.h5";
  DiagnosticSink sink;
  ASSERT_TRUE(write_field_hdf5(table, file, sink));
  const auto back = read_field_hdf5(file, "/records", {}, sink);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->columns.at(1).name, "stress");
  EXPECT_EQ(back->columns.at(0).unit, "mm");
  EXPECT_EQ(back->records(1, 0), 0.1);
  EXPECT_EQ(back->records(2, 1), -6);
  const std::string first = bytes_of(file);
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // HDF5 would keep the time in whole seconds
  ASSERT_TRUE(write_field_hdf5(table, file, sink));
  EXPECT_EQ(bytes_of(file), first);
}

TEST(Hdf5InMemory, IsTheSameFile) {
  const std::string name = fixture("layouts.h5");
  const Resource memory("a.mesoz/layouts.h5", std::make_shared<const std::string>(bytes_of(name)));
  DiagnosticSink sink;
  for (const char* path : {"/contiguous", "/chunked", "/big", "/named"}) {
    const auto file = read_field_hdf5(name, path, {}, sink), image = read_field_hdf5(memory, path, {}, sink);
    ASSERT_TRUE(file && image) << path;
    ASSERT_EQ(image->records.rows(), file->records.rows());
    for (std::size_t r = 0; r < file->records.rows(); ++r)
      for (std::size_t c = 0; c < file->records.columns(); ++c) EXPECT_EQ(image->records(r, c), file->records(r, c));
  }
  EXPECT_TRUE(read_field_hdf5_integers(memory, "/cells", {}, sink));
  const Resource cut("a.mesoz/cut.h5", std::make_shared<const std::string>(bytes_of(name).substr(0, 2000)));
  EXPECT_FALSE(read_field_hdf5(cut, "/chunked", {}, sink));
  EXPECT_THAT(render(sink.diagnostics().at(0)), testing::HasSubstr("damaged or cut short"));
}

// However little memory there may be: the numbers then stand in a file.
TEST(Hdf5InAFile, IsTheSameAsInMemory) {
  DiagnosticSink sink;
  for (const char* path : {"/chunked", "/big", "/group"}) {
    const auto memory = read_field_hdf5(fixture("layouts.h5"), path, {}, sink),
               file = read_field_hdf5(fixture("layouts.h5"), path, {.max_memory_bytes = 100}, sink);
    ASSERT_TRUE(memory && file) << path;
    ASSERT_EQ(file->records.rows(), memory->records.rows());
    for (std::size_t r = 0; r < memory->records.rows(); ++r)
      for (std::size_t c = 0; c < memory->records.columns(); ++c) EXPECT_EQ(file->records(r, c), memory->records(r, c));
  }
}

TEST(Hdf5Faults, AreReportedOnce) {
  EXPECT_THAT(fault_of("/nowhere.h5", "/a"), testing::HasSubstr("IMPORT_UNREADABLE"));
  EXPECT_THAT(fault_of(fixture("layouts.h5"), "/nothing"), testing::HasSubstr("no data set '/nothing'"));
  EXPECT_THAT(fault_of(fixture("layouts.h5"), "/texts"), testing::HasSubstr("FIELD_FILE_UNSUPPORTED"));
  EXPECT_THAT(fault_of(fixture("layouts.h5"), "/cube"), testing::HasSubstr("of 3 dimensions"));
  EXPECT_THAT(fault_of(fixture("layouts.h5"), "/contiguous,/cells"), testing::HasSubstr("with 2 rows beside"));
  EXPECT_THAT(fault_of(fixture("layouts.h5"), "/chunked", {.cancelled = [] { return true; }}),
              testing::HasSubstr("CANCELLED"));
  const std::string cut = testing::TempDir() + "cut.h5", whole = bytes_of(fixture("layouts.h5"));
  std::ofstream(cut, std::ios::binary) << whole.substr(0, whole.size() / 2);
  EXPECT_THAT(fault_of(cut, "/chunked"), testing::HasSubstr("damaged or cut short"));
  std::ofstream(cut, std::ios::binary) << "x,y\n1,2\n";
  EXPECT_THAT(fault_of(cut, "/chunked"), testing::HasSubstr("no HDF5 file"));
}

// elsewhere.h5: nothing that a file says makes a reader open another one, or hold more than it was allowed.
TEST(Hdf5Faults, OtherFilesAreNotRead) {
  const std::string file = fixture("elsewhere.h5");
  EXPECT_THAT(fault_of(file, "/external_link"), testing::HasSubstr("the link '/external_link' to another file is not"));
  EXPECT_THAT(fault_of(file, "/soft_link_out"), testing::HasSubstr("the link '/soft_link_out' to another file is not"));
  EXPECT_THAT(fault_of(file, "/"), testing::HasSubstr("to another file is not supported"));
  EXPECT_THAT(fault_of(file, "/virtual"), testing::HasSubstr("'/virtual' whose numbers are in other files"));
  EXPECT_THAT(fault_of(file, "/external_storage"), testing::HasSubstr("whose numbers are in other files"));
  EXPECT_THAT(fault_of(file, "/circle"), testing::HasSubstr("no data set '/circle'"));
  DiagnosticSink sink;
  EXPECT_TRUE(read_field_hdf5(file, "/soft_link", {}, sink)) << "a link inside the file is one of its names";
}

TEST(Hdf5Faults, SizesAreLimited) {
  const std::string file = fixture("elsewhere.h5");
  EXPECT_THAT(fault_of(file, "/wide"), testing::HasSubstr("of 20000 columns is not supported"));
  EXPECT_THAT(fault_of(file, "/huge"), testing::HasSubstr("LIMIT_MEMORY"));  // 2^34 rows in a file of some kilobytes
  DiagnosticSink sink;
  const auto table = read_field_hdf5(file, "/long_names", {}, sink);
  ASSERT_TRUE(table);
  EXPECT_TRUE(table->columns.empty());
}

// The library itself goes on for ever with the first of these, and ends the process with others.
TEST(Hdf5Faults, DamagedTextsOfVariableLengthEndNothing) {
  const std::string whole = bytes_of(fixture("layouts.h5")), damaged = testing::TempDir() + "damaged_texts.h5";
  const std::size_t heap = whole.find("GCOL"), length = whole.find("szz", heap) - 8;
  for (const std::uint64_t wrong : {std::uint64_t{3000}, std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
    std::string bytes = whole;
    for (std::size_t i = 0; i < 8; ++i) bytes[length + i] = static_cast<char>(wrong >> (8 * i) & 0xFF);
    std::ofstream(damaged, std::ios::binary) << bytes;
    EXPECT_THAT(fault_of(damaged, "/named"), testing::HasSubstr("attribute 'components' of '/named'")) << wrong;
  }
}

TEST(Hdf5Faults, TheLibraryPrintsNothing) {
  testing::internal::CaptureStderr();
  const std::string damaged = testing::TempDir() + "damaged.h5";
  std::string bytes = bytes_of(fixture("layouts.h5"));
  std::fill(bytes.begin() + 60, bytes.begin() + 2000, '\x7F');
  std::ofstream(damaged, std::ios::binary) << bytes;
  DiagnosticSink sink;
  EXPECT_FALSE(read_field_hdf5(damaged, "/chunked", {}, sink));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(sink.diagnostics().size(), 1U);
}

}  // namespace
}  // namespace meso
