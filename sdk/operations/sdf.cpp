// SPDX-License-Identifier: Apache-2.0
#include "meso/operations/sdf.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <type_traits>

#include "load_sdf_mesh.hpp"
#include "measured_mesh_sink.hpp"
#include "mesh_warnings.hpp"
#include "meso/base/memory_mesh_sink.hpp"
#include "meso/base/number.hpp"
#include "meso/export_mesh/mesh_writer.hpp"
#include "meso/implicit/accurate_mesh.hpp"
#include "meso/implicit/compile.hpp"
#include "meso/implicit/contour.hpp"
#include "meso/implicit/surface_edges.hpp"
#include "meso/import_surface_mesh/read_surface_mesh.hpp"
#include "meso/mesh_distance/mesh_field.hpp"
#include "meso/sdf/build_field.hpp"
#include "meso/sdf/clamped_values.hpp"
#include "meso/sdf/thinnest_wall.hpp"
#include "stopwatch.hpp"

namespace meso::operations {
namespace fs = std::filesystem;

namespace {

struct Output {
  MeshFormat format{};
  Coordinates coordinates{};
};

std::optional<Output> output_of(const std::string& path, const SdfOptions& options, DiagnosticSink& sink) {
  const auto format = mesh_format_of(path);
  const auto refuse = [&](const char* why) {
    sink.report({.code = Code::usage, .args = {why}});
    return std::nullopt;
  };
  if (!format) {
    sink.report({.code = Code::sdf_extension, .args = {path}});
    return std::nullopt;
  }
  if (options.ascii && format != MeshFormat::stl) return refuse("--ascii has an effect for .stl only");
  Output output{.format = options.ascii ? MeshFormat::stl_ascii : *format, .coordinates = Coordinates::as_float};
  if (options.double_coordinates) {
    if (!can_hold_doubles(output.format)) return refuse("--double has no effect for .stl, which holds floats");
    output.coordinates = Coordinates::as_double;
  }
  return output;
}

/// Between two steps: whether to go on. Steps themselves report what stopped them.
bool go_on(const RunOptions& run, DiagnosticSink& sink) {
  if (!run.should_stop()) return true;
  sink.report({.code = run.out_of_time() ? Code::limit_time : Code::cancelled});
  return false;
}

implicit::Grid grid_of(const sdf::Program& program, const Box3& box) {
  implicit::Grid grid{.box = box};
  if (program.samples.size() == 1) {
    grid.nodes = implicit::nodes_for_total(box, program.samples[0]);
  } else {
    for (std::size_t i = 0; i < 3; ++i) grid.nodes[i] = static_cast<std::int32_t>(program.samples[i]);
  }
  return grid;
}

/// A field that certainly has no inside needs no samples.
class Nothing final : public implicit::GridSource {
 public:
  explicit Nothing(const Box3& box) : grid_{.box = box} {}
  [[nodiscard]] const implicit::Grid& grid() const override { return grid_; }
  [[nodiscard]] std::unique_ptr<implicit::GridSampler> sampler() const override { return std::make_unique<Sampler>(); }

 private:
  class Sampler final : public implicit::GridSampler {
    void begin_slab(std::int32_t, std::int32_t) override {}
    void row(std::int32_t, std::int32_t, float* values, std::uint64_t* inside) override {
      std::fill_n(values, 2, 1.0f);
      *inside = 0;
    }
    void values_at(std::span<const Vec3> points, double* out) override { std::fill_n(out, points.size(), 1.0); }
  };
  implicit::Grid grid_;
};

double largest_spacing(const implicit::Grid& grid) {
  return std::max({grid.spacing(0), grid.spacing(1), grid.spacing(2)});
}

/// A program made ready for contouring on any grid.
class Job {
 public:
  Job(const sdf::Program& program, const SdfOptions& options, DiagnosticSink& sink)
      : program_(program), options_(options), sink_(sink) {}

  std::optional<SdfReport> run(const Output& output);

 private:
  std::unique_ptr<implicit::GridSource> source_on(const implicit::Grid& grid) const;
  bool write(const Output& output);
  template <class Real>
  bool contour_into(MeshSink& writer);
  bool make_accurate(MeshSink& into);
  [[nodiscard]] double smallest_feature() const;
  bool extrapolate();
  void warn(const Output& output) const;
  bool warn_of_rounding(const Output& output) const;

  const sdf::Program& program_;
  const SdfOptions& options_;
  DiagnosticSink& sink_;
  std::optional<implicit::Field> field_;
  bool certainly_empty_ = false;
  double thickness_ = 0;  // of the mesh
  SdfReport report_;
};

std::unique_ptr<implicit::GridSource> Job::source_on(const implicit::Grid& grid) const {
  if (certainly_empty_) return std::make_unique<Nothing>(grid.box);
  if (!implicit::check_grid(grid, options_.run, sink_)) return nullptr;
  return implicit::compile(field_->term(), grid, {.strict_math = options_.strict_math}, options_.run, sink_);
}

/// From a tolerance, or simplified: made in memory, then written.
bool Job::make_accurate(MeshSink& into) {
  // To a tolerance, sharp wherever there may be edges; a smooth surface takes a fifth of the samples.
  const bool sharp = options_.tolerance > 0
                         ? !certainly_empty_ && implicit::may_have_edges(field_->term(), report_.grid.box)
                         : options_.sharp;
  const auto made =
      implicit::make_accurate_mesh([this](const implicit::Grid& grid) { return source_on(grid); }, report_.grid,
                                   {.tolerance = options_.tolerance,
                                    .simplify = options_.simplify,
                                    .smallest_feature = smallest_feature(),
                                    .sharp = sharp},
                                   options_.run, sink_);
  if (!made) return false;
  report_.grid = made->grid;
  report_.points = made->mesh.points.size();
  report_.triangles = made->mesh.triangles.size();
  report_.euler = made->euler;
  thickness_ = thickness_of(made->mesh);
  report_.accuracy = {
      .distance = made->distance, .grid_samples = made->grid_samples, .surface_samples = made->surface_samples};
  return write_mesh(made->mesh, into);
}

/// The thinnest wall that is known of; 0: none is.
double Job::smallest_feature() const {
  const auto wall = sdf::thinnest_wall(program_);
  return wall ? wall->thickness : 0;
}

template <class Real>
bool Job::contour_into(MeshSink& writer) {
  MeasuredMeshSink<Real> measured(writer);
  MeshSink& into = options_.measure ? static_cast<MeshSink&>(measured) : writer;
  const auto take_measures = [&] {
    const implicit::Grid& grid = report_.grid;
    if (options_.measure) report_.measures = measured.measures(grid.spacing(0) * grid.spacing(1) * grid.spacing(2));
    return true;
  };
  if (options_.tolerance > 0 || options_.simplify > 0) return make_accurate(into) && take_measures();
  const auto source = source_on(report_.grid);
  if (!source) return false;
  const auto contoured =
      implicit::contour(*source, into,
                        {.polish = options_.polish,
                         .coordinate_step = std::is_same_v<Real, float> ? implicit::float_step(report_.grid.box) : 0,
                         .sharp = options_.sharp,
                         .collapse_slivers = options_.no_slivers},
                        options_.run, sink_);
  if (!contoured) return false;
  thickness_ = contoured->cells_thick() * largest_spacing(report_.grid);
  report_.points = contoured->points;
  report_.triangles = contoured->triangles;
  report_.euler = contoured->euler;
  return take_measures();
}

/// Contours into a file; the file's own faults are told by commit().
bool Job::write(const Output& output) {
  auto file = OutputFile::create(program_.output, options_.existing, sink_);
  if (!file) return false;
  const auto writer = make_mesh_writer(output.format, *file, output.coordinates);
  const std::size_t errors = sink_.error_count();
  const bool contoured =
      output.coordinates == Coordinates::as_double ? contour_into<double>(*writer) : contour_into<float>(*writer);
  if (sink_.error_count() > errors || !file->commit(sink_) || !contoured) return false;
  std::error_code error;
  const auto bytes = fs::file_size(program_.output, error);
  report_.bytes = error ? 0 : bytes;
  return true;
}

/// Errors of volume and area go with the square of the spacing, so those of half as many samples along each axis tell
/// what the limit is (Richardson 1911).
bool Job::extrapolate() {
  implicit::Grid coarse = report_.grid;
  double ratio = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int32_t cells = coarse.nodes[axis] - 1;
    if (cells < 4) return true;
    coarse.nodes[axis] = cells / 2 + 1;
    ratio *= coarse.spacing(axis) / report_.grid.spacing(axis);
  }
  RunOptions run = options_.run;
  run.progress = nullptr;  // it would begin anew
  const auto source = source_on(coarse);
  NoMesh none;
  MeasuredMeshSink<double> measured(none);
  if (!source ||
      !implicit::contour(*source, measured, {.polish = options_.polish, .sharp = options_.sharp}, run, sink_))
    return false;
  const MeshMeasures& fine = *report_.measures;
  const MeshMeasures half = measured.measures(0);
  const double square = std::pow(ratio, 2. / 3), share = 1 / (square - 1);
  report_.extrapolated = {.volume = fine.volume + share * (fine.volume - half.volume),
                          .area = fine.area + share * (fine.area - half.area)};
  return true;
}

void Job::warn(const Output& output) const {
  if (report_.measures) warn_of_cavities(*report_.measures, sink_);
  if (report_.triangles == 0) sink_.report({.code = Code::sdf_empty, .args = {program_.output}});
  const bool rounded = warn_of_rounding(output);
  sdf::report_clamped(sdf::clamped_values(program_, report_.grid.box), sink_);
  const double spacing = largest_spacing(report_.grid);
  if (const double feature = smallest_feature(); feature > 0 && feature < options_.tolerance) {
    sink_.report({.code = Code::feature_below_tolerance,
                  .args = {program_.output, format_number(feature), format_number(options_.tolerance)}});
    return;
  }
  if (const auto wall = sdf::thinnest_wall(program_); wall && wall->thickness < spacing) {
    const sdf::Word& word = wall->made_by->word;
    Diagnostic d{.code = Code::sdf_thin_wall,
                 .args = {word.text, format_number(wall->thickness), format_number(spacing)}};
    point_at(d, word);
    sink_.report(std::move(d));
  } else if (!warn_of_period(program_, spacing, sink_) && !rounded) {
    double samples = 1;
    for (const std::int32_t n : report_.grid.nodes) samples *= n;
    warn_of_thinness(thickness_, {samples, spacing}, sink_);
  }
}

/// Whether floats are too coarse for the coordinates. Contouring keeps vertices a thousandth of a cell apart.
bool Job::warn_of_rounding(const Output& output) const {
  if (output.coordinates == Coordinates::as_double || report_.triangles == 0) return false;
  const implicit::Grid& grid = report_.grid;
  double reach = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    reach = std::max({reach, std::abs(grid.box.min[axis]), std::abs(grid.box.max[axis])});
  const double step = implicit::float_step(grid.box),
               spacing = std::min({grid.spacing(0), grid.spacing(1), grid.spacing(2)});
  if (step <= 4e-3 * spacing) return false;
  sink_.report({.code = Code::sdf_far,
                .args = {format_number(reach), format_number(step), program_.output, format_number(spacing)}});
  return true;
}

std::optional<SdfReport> Job::run(const Output& output) {
  Stopwatch watch;
  const auto load = [&](const std::string& path, DiagnosticSink& told) {
    return load_sdf_mesh(path, options_.run, told);
  };
  field_ = sdf::build_field(program_, load, sink_);
  if (!field_ || !go_on(options_.run, sink_)) return std::nullopt;
  const auto box = sdf::box_of(program_, *field_, sink_);
  if (!box || !go_on(options_.run, sink_)) return std::nullopt;
  certainly_empty_ = box->certainly_empty;
  // Beyond any grid, and beyond the numbers that count its nodes.
  constexpr double most_along = 65534;
  if (program_.samples.size() == 1 && std::cbrt(program_.samples[0]) > most_along) {
    const double along = std::round(std::cbrt(program_.samples[0]));
    sink_.report({.code = Code::limit_grid, .args = {format_number(along), "each axis", format_number(most_along)}});
    return std::nullopt;
  }
  report_.grid = grid_of(program_, box->box);
  report_.seconds.read = watch.lap();
  if (!write(output)) return std::nullopt;
  report_.seconds.contour = watch.lap();
  // Errors of refined meshes follow no law of the spacing.
  if (options_.measure && report_.triangles > 0 && !report_.accuracy && !extrapolate()) return std::nullopt;
  report_.seconds.extrapolate = watch.lap();
  warn(output);
  report_.seconds.total = watch.total();
  return report_;
}

}  // namespace

std::shared_ptr<const implicit::ExternalField> load_sdf_mesh(const std::string& path, const RunOptions& run,
                                                             DiagnosticSink& sink) {
  if (!go_on(run, sink)) return nullptr;
  const auto mesh = read_surface_mesh_file(path, sink, run);
  return mesh && go_on(run, sink) ? implicit::MeshField::make(*mesh, path, run, sink) : nullptr;
}

std::optional<Box3> sdf_box(const sdf::Program& program, const RunOptions& run, DiagnosticSink& sink) {
  const auto load = [&](const std::string& path, DiagnosticSink& told) { return load_sdf_mesh(path, run, told); };
  const auto field = sdf::build_field(program, load, sink);
  const auto box = field ? sdf::box_of(program, *field, sink) : std::nullopt;
  return box ? std::optional(box->box) : std::nullopt;
}

std::optional<SdfReport> run_sdf(const sdf::Program& program, const SdfOptions& options, DiagnosticSink& sink) {
  const auto output = output_of(program.output, options, sink);
  if (output && options.tolerance > 0 && program.has_samples) {
    sink.report({.code = Code::usage, .args = {"--tolerance picks the samples; -s has no effect beside it"}});
    return std::nullopt;
  }
  return output ? Job(program, options, sink).run(*output) : std::nullopt;
}

sdf::ProgramOptions::Text read_text(const std::string& path) {
  constexpr std::size_t most_text_bytes = std::size_t{16} << 20;
  std::error_code error;
  if (fs::is_directory(path, error)) return {.why_not = std::make_error_code(std::errc::is_a_directory).message()};
  std::ifstream in(path, std::ios::binary);
  if (!in) return {.why_not = std::generic_category().message(errno)};
  // Words of a program, not data: whatever never ends (/dev/zero, a pipe) must not fill the memory.
  std::string text(most_text_bytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (text.size() > most_text_bytes) return {.why_not = "it holds more than 16 MiB"};
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
    return {.why_not = "it is UTF-16; save it as UTF-8"};
  return {.text = std::move(text)};
}

}  // namespace meso::operations
