// SPDX-License-Identifier: Apache-2.0
// Thousands of damaged copies of one good file of each format: every one is read or told about once, in little time and
// memory. The damage is the same in every run.
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <chrono>
#include <fstream>
#include <random>

#include "meso/import_field_file/read_field_file.hpp"

namespace meso {
namespace {

constexpr int copies = 2000;
constexpr std::uint64_t budget = std::uint64_t{64} << 20;

struct Good {
  const char* file;
  ValueFormat format;
  const char* path = "";
};

std::string bytes_of(const std::string& name) {
  std::ifstream in(std::string(MESO_SOURCE_DIR) + "/" + name, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

long peak_kibibytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

/// One to four faults: a cut, flipped bits, a byte for another one, digits, a piece that is left out or stands twice.
std::string damaged(std::string bytes, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
  for (std::size_t faults = 1 + below(4); faults > 0 && !bytes.empty(); --faults) {
    const std::size_t at = below(bytes.size()), size = below(40);
    switch (below(6)) {
      case 0:
        bytes.resize(at);
        break;
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 2:
        bytes[at] = static_cast<char>(random());
        break;
      case 3:
        bytes[at] = "0123456789-+.eE \n"[below(17)];
        break;
      case 4:
        bytes.erase(at, size);
        break;
      default:
        bytes.insert(at, bytes.substr(below(bytes.size()), size));
    }
  }
  return bytes;
}

class FieldMutations : public testing::TestWithParam<Good> {};

TEST_P(FieldMutations, AreReadOrToldOnce) {
  const std::string good = bytes_of(GetParam().file);
  ASSERT_FALSE(good.empty());
  std::mt19937 random(11);
  int read = 0;
  const long before = peak_kibibytes();
  const auto start = std::chrono::steady_clock::now();
  for (int n = 0; n < copies; ++n) {
    const auto bytes = std::make_shared<const std::string>(damaged(good, random));
    DiagnosticSink sink;
    const auto table = read_field_file({.file = Resource("damaged", bytes),
                                        .format = GetParam().format,
                                        .path = GetParam().path,
                                        .rows = 10,
                                        .columns = 4,
                                        .run = {.max_memory_bytes = budget}},
                                       sink);
    read += table ? 1 : 0;
    ASSERT_EQ(sink.error_count(), table ? 0U : 1U) << "copy " << n;
    ASSERT_TRUE(!table || table->records.rows() * table->records.columns() > 0) << "copy " << n;
  }
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  EXPECT_LT(read, copies);
  EXPECT_LT(seconds.count(), 60);
  EXPECT_LT(peak_kibibytes() - before, 4 * static_cast<long>(budget >> 10));
}

INSTANTIATE_TEST_SUITE_P(
    Formats, FieldMutations,
    testing::Values(Good{"examples/documents/stress.csv", ValueFormat::csv},
                    Good{"importers/field_frd/fixtures/cube.frd", ValueFormat::frd},
                    Good{"importers/field_frd/fixtures/cube_binary.frd", ValueFormat::frd},
                    Good{"importers/field_msh/fixtures/box22.msh", ValueFormat::msh},
                    Good{"importers/field_msh/fixtures/box41.msh", ValueFormat::msh},
                    Good{"importers/field_msh/fixtures/box41_binary.msh", ValueFormat::msh},
                    Good{"importers/field_vtk/fixtures/mesh_v42.vtk", ValueFormat::vtk},
                    Good{"importers/field_vtk/fixtures/mesh_v51_binary.vtk", ValueFormat::vtk},
                    Good{"importers/field_vtk/fixtures/rectilinear.vtk", ValueFormat::vtk},
                    Good{"importers/field_vtk/fixtures/points.vtk", ValueFormat::vtk},
                    Good{"importers/field_vtk/fixtures/mesh_ascii.vtu", ValueFormat::vtu},
                    Good{"importers/field_vtk/fixtures/mesh_base64.vtu", ValueFormat::vtu},
                    Good{"importers/field_vtk/fixtures/mesh_zlib.vtu", ValueFormat::vtu},
                    Good{"importers/field_vtk/fixtures/mesh_appended_raw.vtu", ValueFormat::vtu},
                    Good{"importers/field_hdf5/fixtures/layouts.h5", ValueFormat::hdf5, "/contiguous"},
                    Good{"importers/field_hdf5/fixtures/layouts.h5", ValueFormat::hdf5, "/group"},
                    Good{"importers/field_hdf5/fixtures/layouts.h5", ValueFormat::hdf5, "/chunked"},
                    Good{"importers/field_hdf5/fixtures/layouts.h5", ValueFormat::hdf5, "/named"}),
    [](const auto& one) {
      std::string name = std::string(one.param.file) + one.param.path;
      name = name.substr(name.find_last_of('/', name.find('.')) + 1);
      std::replace_if(
          name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
      return name;
    });

}  // namespace
}  // namespace meso
