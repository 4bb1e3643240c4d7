// SPDX-License-Identifier: Apache-2.0
// Vector fields: base64, nearest records, thinning, ten million records in a file, HDF5 beside a plain H5Dread.
#include <benchmark/benchmark.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "meso/fields/base64.hpp"
#include "meso/fields/point_search.hpp"
#include "meso/fields/statistics.hpp"
#ifdef MESO_FIELD_LIBRARIES
#include <hdf5.h>

#include "meso/import_field_hdf5/read_hdf5.hpp"
#endif

namespace meso::fields {
namespace {

std::vector<Vec3> random_points(std::size_t count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> one(0, 1);
  std::vector<Vec3> points(count);
  for (Vec3& p : points) p = {one(random), one(random), one(random)};
  return points;
}

void decode(benchmark::State& state) {
  std::mt19937_64 random(1);
  std::vector<std::byte> bytes(std::size_t{1} << 24);
  for (std::byte& b : bytes) b = static_cast<std::byte>(random());
  std::string text = encode_base64(bytes.data(), bytes.size());
  if (state.range(0) > 0) {
    std::string lines;
    for (std::size_t i = 0; i < text.size(); i += 76) lines += text.substr(i, 76) + "\n";
    text = std::move(lines);
  }
  std::vector<std::byte> out(base64_bytes_at_most(text.size()));
  for (auto _ : state) benchmark::DoNotOptimize(decode_base64(text, out.data()));
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * bytes.size()));
}
BENCHMARK(decode)->ArgName("lines")->Arg(0)->Arg(76);

// Records and questions in random order: neighbours in one list are none in space.
void nearest(benchmark::State& state) {
  const PointSearch search = *PointSearch::make(random_points(static_cast<std::size_t>(state.range(0)), 2), {});
  const std::vector<Vec3> questions = random_points(std::size_t{1} << 16, 3);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(search.nearest(questions[i]));
    i = (i + 1) & 0xFFFF;
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()));
}
BENCHMARK(nearest)->ArgName("records")->Arg(100'000)->Arg(10'000'000);

void tree_of_points(benchmark::State& state) {
  const std::vector<Vec3> points = random_points(static_cast<std::size_t>(state.range(0)), 2);
  for (auto _ : state) benchmark::DoNotOptimize(PointSearch::make(points, {}));
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * points.size()));
}
BENCHMARK(tree_of_points)->ArgName("records")->Arg(100'000)->Arg(10'000'000)->Unit(benchmark::kMillisecond);

void thinning(benchmark::State& state) {
  const std::vector<Vec3> points = random_points(static_cast<std::size_t>(state.range(0)), 4);
  for (auto _ : state) benchmark::DoNotOptimize(thin(points, 0.01, {}));
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * points.size()));
}
BENCHMARK(thinning)->ArgName("records")->Arg(1'000'000);

/// Memory of this process that no file backs, in MiB.
double own_mebibytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("RssAnon:")) return std::stod(line.substr(8)) / 1024;
  return 0;
}

// Every number of ten million records of four, in a file of 320 MB: mapped, so that memory stays where it was.
void mapped_records(benchmark::State& state) {
  const auto file = std::filesystem::temp_directory_path() / "meso_bench_mapped.raw";
  const auto rows = static_cast<std::size_t>(state.range(0));
  {
    std::ofstream out(file, std::ios::binary);
    std::mt19937_64 random(6);
    std::vector<double> block(4096);
    for (std::size_t done = 0; done < 4 * rows; done += block.size()) {
      for (double& v : block) v = static_cast<double>(random() % 100'000) / 1000;
      out.write(reinterpret_cast<const char*>(block.data()), 8 * static_cast<std::streamsize>(block.size()));
    }
  }
  const double before = own_mebibytes();
  double most = before;
  for (auto _ : state) {
    std::string error;
    const auto records = Records::map(ResourceBytes::open(file, error), {.rows = rows, .columns = 4});
    benchmark::DoNotOptimize(statistics(*records, {}));
    most = std::max(most, own_mebibytes());
  }
  state.counters["own_MiB"] = most - before;
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * rows * 32));
  std::filesystem::remove(file);
}
BENCHMARK(mapped_records)->ArgName("records")->Arg(10'000'000)->Unit(benchmark::kMillisecond);

#ifdef MESO_FIELD_LIBRARIES
constexpr hsize_t rows = 2'000'000, columns = 7;

/// Written once: `packed` in chunks of 16384 rows, shuffled and deflated.
std::string hdf5_file(bool packed) {
  const std::string file =
      (std::filesystem::temp_directory_path() / (packed ? "meso_bench_packed.h5" : "meso_bench_chunked.h5")).string();
  std::mt19937_64 random(5);
  std::vector<double> values(rows * columns);
  for (double& v : values) v = static_cast<double>(random() % 100'000) / 1000;
  const hid_t out = H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hsize_t size[]{rows, columns}, chunk[]{16384, columns};
  const hid_t space = H5Screate_simple(2, size, nullptr), list = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(list, 2, chunk);
  if (packed) {
    H5Pset_shuffle(list);
    H5Pset_deflate(list, 1);
  }
  const hid_t set = H5Dcreate2(out, "records", H5T_IEEE_F64LE, space, H5P_DEFAULT, list, H5P_DEFAULT);
  H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  H5Dclose(set);
  H5Pclose(list);
  H5Sclose(space);
  H5Fclose(out);
  return file;
}

void hdf5_plain(benchmark::State& state) {
  const std::string file = hdf5_file(state.range(0) != 0);
  for (auto _ : state) {
    const hid_t in = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    const hid_t set = H5Dopen2(in, "records", H5P_DEFAULT);
    std::vector<double> values(rows * columns);
    H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    benchmark::DoNotOptimize(values.data());
    H5Dclose(set);
    H5Fclose(in);
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * rows * columns * sizeof(double)));
  std::filesystem::remove(file);
}
// With a small budget the numbers go to a temporary file.
void hdf5_ours(benchmark::State& state) {
  const std::string file = hdf5_file(state.range(0) != 0);
  const std::uint64_t budget = static_cast<std::uint64_t>(state.range(1)) << 20;
  const double before = own_mebibytes();
  double most = before;
  for (auto _ : state) {
    DiagnosticSink sink;
    const auto table = read_field_hdf5(file, "/records", {.max_memory_bytes = budget}, sink);
    most = std::max(most, own_mebibytes());
    benchmark::DoNotOptimize(table);
  }
  state.counters["own_MiB"] = most - before;
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * rows * columns * sizeof(double)));
  std::filesystem::remove(file);
}
BENCHMARK(hdf5_plain)->ArgName("packed")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(hdf5_ours)
    ->ArgNames({"packed", "budget_MiB"})
    ->ArgsProduct({{0, 1}, {4096, 64}})
    ->Unit(benchmark::kMillisecond);
#endif

}  // namespace
}  // namespace meso::fields

BENCHMARK_MAIN();
