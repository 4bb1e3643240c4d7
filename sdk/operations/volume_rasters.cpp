// SPDX-License-Identifier: Apache-2.0
// Voxels and slices of a program's solid.

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <limits>

#include "meso/base/number.hpp"
#include "meso/export_slices/slice_files.hpp"
#include "meso/export_voxels/voxel_writer.hpp"
#include "meso/expr/expression.hpp"
#include "meso/implicit/slices.hpp"
#include "meso/implicit/voxels.hpp"
#include "volume_job.hpp"
#ifdef MESO_OPERATIONS_HDF5
#include "meso/export_voxels/hdf5_voxels.hpp"
#endif

namespace meso::operations {
namespace {

/// Remembers whether there was anything.
class Watched final : public VoxelSink {
 public:
  explicit Watched(VoxelSink& into) : into_(into) {}
  [[nodiscard]] bool begin(const VoxelArray& array) override { return into_.begin(array); }
  [[nodiscard]] bool write_plane(std::string_view bytes) override {
    anything_ = anything_ || bytes.find_first_not_of('\0') != bytes.npos;
    return into_.write_plane(bytes);
  }
  [[nodiscard]] bool finish() override { return into_.finish(); }
  [[nodiscard]] bool anything() const { return anything_; }

 private:
  VoxelSink& into_;
  bool anything_ = false;
};

std::unique_ptr<VoxelSink> voxel_writer(const VolumeJob& job, OutputFile& file) {
  if (const auto format = voxel_format_of(job.path)) return make_voxel_writer(*format, file);
#ifdef MESO_OPERATIONS_HDF5
  if (!file.temporary_path().empty()) return std::make_unique<Hdf5Voxels>(file.temporary_path());
  job.refuse("HDF5 is written to regular files only");
#else
  job.refuse("this build writes no HDF5; use .nrrd or .vti");
#endif
  return nullptr;
}

/// Where slices lie: along which axis, and at which heights.
struct SlicePlan {
  std::size_t axis = 2;
  double first = 0, step = 1;
  std::int32_t count = 1;
  bool numbered = true;
};

struct SliceText {
  std::optional<double> step, at, count;
  std::size_t axis = 2;
};

std::optional<double> millimeters(std::string_view text) {
  const auto parsed = expr::parse_expression(text, LengthUnit::millimeter);
  if (!parsed.expression || !parsed.expression->is_constant()) return std::nullopt;
  if (text.ends_with("deg") || text.ends_with("rad")) return std::nullopt;
  const auto value = expr::evaluate(*parsed.expression, {});
  return value ? std::optional(value.value) : std::nullopt;
}

std::optional<SliceText> parse_slices(std::string_view text) {
  SliceText out;
  while (!text.empty()) {
    const std::string_view part = text.substr(0, text.find(','));
    text.remove_prefix(std::min(text.size(), part.size() + 1));
    const std::size_t equals = part.find('=');
    if (equals == part.npos) return std::nullopt;
    const std::string_view key = part.substr(0, equals), value = part.substr(equals + 1);
    if (key == "axis") {
      if (value != "x" && value != "y" && value != "z") return std::nullopt;
      out.axis = static_cast<std::size_t>(value[0] - 'x');
      continue;
    }
    const auto number = key == "count" ? parse_number(value) : millimeters(value);
    if (!number) return std::nullopt;
    if (key == "step" && *number > 0)
      out.step = number;
    else if (key == "at")
      out.at = number;
    else if (key == "count" && *number >= 1 && *number <= 1e6 && *number == std::floor(*number))
      out.count = number;
    else
      return std::nullopt;
  }
  if (int(out.step.has_value()) + int(out.at.has_value()) + int(out.count.has_value()) > 1) return std::nullopt;
  return out;
}

std::optional<SlicePlan> plan_slices(const VolumeJob& job) {
  const auto text = parse_slices(job.options.slices.value_or(""));
  if (!text) {
    job.refuse(
        "--slices takes axis=x|y|z and one of step=LENGTH, at=LENGTH, count=N, separated by commas: axis=z,step=0.2mm");
    return std::nullopt;
  }
  SlicePlan plan{.axis = text->axis};
  const double low = job.box.min[plan.axis], high = job.box.max[plan.axis], size = high - low;
  if (text->at) {
    if (*text->at < low || *text->at > high) {
      job.refuse("--slices at=" + format_number(*text->at) + " is outside of the box, " + format_number(low) + " to " +
                 format_number(high));
      return std::nullopt;
    }
    return SlicePlan{.axis = plan.axis, .first = *text->at, .step = size, .numbered = false};
  }
  // In the middles of layers.
  const double layers =
      text->step ? std::max(1.0, std::floor(size / *text->step + 1e-9)) : text->count.value_or(job.samples[plan.axis]);
  if (layers > 1e6) {
    job.refuse("--slices asks for more than a million slices");
    return std::nullopt;
  }
  plan.count = static_cast<std::int32_t>(layers);
  plan.step = text->step.value_or(size / layers);
  plan.first = low + plan.step / 2;
  return plan;
}

/// The solid turned so that slices are its planes along z: the axes keep their order round.
implicit::Field turned(const implicit::Field& field, std::size_t axis) {
  if (axis == 2) return field;
  Mat3 map{{0, 0, 0, 0, 0, 0, 0, 0, 0}}, inverse = map;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t from = (axis + 1 + i) % 3;
    map(i, from) = 1;
    inverse(from, i) = 1;
  }
  return field.mapped({map, {}}, {inverse, {}}, 1);
}

std::string numbered(const std::string& path, std::uint64_t number) {
  const std::size_t dot = path.rfind('.');
  std::string digits = std::to_string(number);
  digits.insert(0, 4 - std::min<std::size_t>(4, digits.size()), '0');
  return path.substr(0, dot) + "_" + digits + path.substr(dot);
}

/// One file of a stack.
bool write_whole(VolumeJob& job, const SlicePlan& plan, std::uint64_t plane, std::string_view bytes) {
  const std::string path = plan.numbered ? numbered(job.path, plane + 1) : job.path;
  auto file = OutputFile::create(path, job.options.existing, job.sink);
  job.report.bytes += bytes.size();
  if (!file) return false;
  const bool written = file->write(bytes);
  return file->commit(job.sink) && written;
}

/// Rows of samples are counted in 32 bits.
bool countable(const VolumeJob& job, const std::array<std::int32_t, 3>& cells, int subsamples) {
  const std::int64_t most = std::numeric_limits<std::int32_t>::max();
  if (std::ranges::all_of(cells, [&](std::int64_t n) { return n * subsamples <= most; })) return true;
  return job.refuse("more than " + std::to_string(most) + " samples along an axis; take fewer voxels or --subsamples");
}

}  // namespace

bool write_voxels(VolumeJob& job) {
  const std::string value = job.options.voxels.value_or("occupancy");
  const bool distance = value == "distance";
  const int m = job.options.subsamples.value_or(value == "density" ? 4 : 1);
  if (!countable(job, job.samples, m)) return false;
  const implicit::VoxelGrid voxels{.box = job.box, .cells = job.samples, .subsamples = {m, m, m}};
  const auto source = job.source(job.field, voxels.samples());
  if (!source) return false;
  auto file = OutputFile::create(job.path, job.options.existing, job.sink);
  if (!file) return false;
  const auto writer = voxel_writer(job, *file);
  if (!writer) return false;
  Watched watched(*writer);
  const std::size_t errors = job.sink.error_count();
  const bool written = implicit::sample_voxels(*source, voxels,
                                               distance             ? implicit::VoxelValue::distance
                                               : value == "density" ? implicit::VoxelValue::density
                                                                    : implicit::VoxelValue::occupancy,
                                               watched, job.options.run, job.sink);
  if (job.sink.error_count() > errors) return false;
  if (!written) (void)file->fail(EIO);  // where the file itself does not know, as with HDF5
  if (!file->commit(job.sink) || !written) return false;
  job.report.cells = job.samples;
  if (!watched.anything()) job.sink.report({.code = Code::sdf_empty, .args = {job.path}});
  return true;
}

bool write_slices(VolumeJob& job) {
  const auto plan = plan_slices(job);
  if (!plan) return false;
  const std::array<std::size_t, 3> axes{(plan->axis + 1) % 3, (plan->axis + 2) % 3, plan->axis};
  Box3 box;
  std::array<std::int32_t, 3> nodes{};
  for (std::size_t i = 0; i < 3; ++i) {
    box.min[i] = job.box.min[axes[i]];
    box.max[i] = job.box.max[axes[i]];
    nodes[i] = job.samples[axes[i]];
  }
  nodes[2] = plan->count;
  box.min.z = plan->first - plan->step / 2;
  box.max.z = box.min.z + plan->step * plan->count;
  const implicit::Field field = turned(job.field, plan->axis);
  job.report.cells = nodes;
  job.report.files = static_cast<std::uint64_t>(plan->count);
  if (lower_extension(job.path) == ".png") {
    const int m = job.options.subsamples.value_or(4);
    if (!countable(job, nodes, m)) return false;
    const implicit::VoxelGrid pixels{.box = box, .cells = nodes, .subsamples = {m, m, 1}};
    const auto source = job.source(field, pixels.samples());
    PngStack stack([&](std::uint32_t plane, std::string_view bytes) { return write_whole(job, *plan, plane, bytes); });
    return source &&
           implicit::sample_voxels(*source, pixels, implicit::VoxelValue::grey, stack, job.options.run, job.sink);
  }
  // Middles of layers are the planes of a grid.
  implicit::Grid grid = implicit::VoxelGrid{.box = box, .cells = {1, 1, plan->count}}.samples();
  for (std::size_t i = 0; i < 2; ++i) {
    grid.nodes[i] = nodes[i];
    grid.box.min[i] = box.min[i];
    grid.box.max[i] = box.max[i];
  }
  const auto source = job.source(field, grid);
  const SliceFrame frame{.min = {box.min.x, box.min.y}, .max = {box.max.x, box.max.y}};
  std::uint64_t plane = 0;
  const auto take = [&](const Slice& s) {
    StringSink svg;
    return write_slice_svg(s, frame, svg) && write_whole(job, *plan, plane++, svg.text());
  };
  return source && implicit::slice(*source, plan->count, take, job.options.run, job.sink);
}

}  // namespace meso::operations
