// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/contour.hpp"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <array>
#include <atomic>
#include <cassert>

#include "face_pass.hpp"
#include "meso/base/memory_mesh_sink.hpp"
#include "ordered_output.hpp"
#include "pulse.hpp"
#include "sliver_collapse.hpp"
#include "vertex_pass.hpp"

namespace meso::implicit {
namespace {

// With the plane below it, a slab of 16.
constexpr std::size_t brick_planes = 15;

std::size_t bricks_of(const Grid& grid) {
  return (static_cast<std::size_t>(grid.nodes[2]) + brick_planes) / brick_planes;
}

// No more threads than TBB has: it would say so on standard error, and they would take turns.
std::size_t jobs_of(const RunOptions& run, std::size_t bricks) {
  const std::size_t wanted = run.jobs == 0 ? static_cast<std::size_t>(tbb::info::default_concurrency()) : run.jobs;
  return std::min(
      {bricks, wanted, tbb::global_control::active_value(tbb::global_control::parameter::max_allowed_parallelism)});
}

// What is known before the start: planes of samples and signs for each thread, and the record of a surface that every
// row crosses four times.
bool memory_fits(const Grid& grid, bool signs_only, std::uint64_t held, const RunOptions& run,
                 DiagnosticSink& diagnostics) {
  const auto nx = static_cast<std::uint64_t>(grid.nodes[0]), ny = static_cast<std::uint64_t>(grid.nodes[1]),
             nz = static_cast<std::uint64_t>(grid.nodes[2]);
  const std::size_t jobs = jobs_of(run, bricks_of(grid));
  const std::uint64_t plane_of_signs = (nx / 64 + 1) * ny * sizeof(std::uint64_t);
  const std::uint64_t thread =
      SampleRows::bytes(nx, ny) + 2 * plane_of_signs + (signs_only ? EdgeEndSampler::bytes(nx, ny) : 0);
  const std::uint64_t record = (ny + 1) * (nz + 1) * (sizeof(RowCounts) + 4 * sizeof(std::uint16_t));
  const std::uint64_t shared = (nx + ny + nz) * sizeof(double) + bricks_of(grid) * sizeof(BrickRecord) + record;
  return fits_memory(grid, held + jobs * thread + shared,
                     "contouring with " + std::to_string(jobs) + (jobs == 1 ? " thread" : " threads"), run,
                     diagnostics);
}

class Contouring {
 public:
  Contouring(const GridSource& source, MeshSink& sink, const ContourOptions& options, const RunOptions& run,
             DiagnosticSink& diagnostics)
      : source_(source),
        sink_(sink),
        options_(options),
        run_(run),
        diagnostics_(diagnostics),
        layout_(source.grid()),
        bricks_(bricks_of(source.grid())),
        jobs_(jobs_of(run, bricks_)),
        records_(bricks_),
        first_vertex_(bricks_ + 1),
        pulse_(run, (layout_.nz + 1) * (layout_.ny + 1)) {}

  std::optional<ContourReport> run();

 private:
  template <class Pass, class Brick>
  bool for_each_brick(OrderedOutput& output, Pass make_pass, Brick do_brick);
  bool fits(std::uint64_t bytes, std::string_view purpose) {
    return fits_memory(source_.grid(), bytes, purpose, run_, diagnostics_);
  }
  OrderedOutput output(bool (MeshSink::*write)(std::string_view)) {
    return {[this, write](std::string_view bytes) { return (sink_.*write)(bytes); }, jobs_,
            run_.max_memory_bytes / (8 * jobs_)};
  }
  bool vertex_pass();
  bool number_vertices();
  bool face_pass();
  std::nullopt_t stopped();

  [[nodiscard]] std::size_t first_plane(std::size_t brick) const { return brick * brick_planes; }
  [[nodiscard]] std::size_t last_plane(std::size_t brick) const {
    return std::min(first_plane(brick) + brick_planes, layout_.nz + 1);
  }

  const GridSource& source_;
  MeshSink& sink_;
  const ContourOptions& options_;
  const RunOptions& run_;
  DiagnosticSink& diagnostics_;
  Layout layout_;
  std::size_t bricks_, jobs_;
  std::vector<BrickRecord> records_;
  std::vector<std::uint64_t> first_vertex_;
  std::atomic<std::uint64_t> recorded_bytes_{0}, sampler_bytes_{0}, triangles_{0};
  Pulse pulse_;
};

// Bricks are handed out in ascending order, so that what the output waits for is always being worked on.
template <class Pass, class Brick>
bool Contouring::for_each_brick(OrderedOutput& output, Pass make_pass, Brick do_brick) {
  std::atomic<std::size_t> ticket{0};
  const auto make_bricks = [&] {
    auto pass = make_pass();
    while (!pulse_.stopped() && !output.failed()) {
      ByteBuffer bytes = output.acquire();
      const std::size_t brick = ticket++;
      if (brick >= bricks_) break;
      do_brick(pass, brick, bytes);
      if (pulse_.stopped()) break;
      output.finish(brick, std::move(bytes));
    }
    if (pulse_.stopped()) output.stop();
  };
  // Memory may run out in any thread: the others must not go on waiting for its brick.
  const auto work = [&](std::size_t) {
    try {
      make_bricks();
    } catch (...) {
      pulse_.stop();
      output.stop();
      throw;
    }
  };
  tbb::task_arena arena(static_cast<int>(jobs_));
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, jobs_, work, tbb::simple_partitioner{}); });
  return !pulse_.stopped() && !output.failed();
}

bool Contouring::vertex_pass() {
  OrderedOutput output = this->output(&MeshSink::write_points);
  pulse_.begin("vertices");
  return for_each_brick(
      output, [&] { return VertexPass(layout_, source_, sink_, options_, [&] { return pulse_.check(); }); },
      [&](VertexPass& pass, std::size_t brick, ByteBuffer& bytes) {
        records_[brick] = pass.run(first_plane(brick), last_plane(brick), bytes, [&] {
          output.offer(brick, bytes);
          return pulse_.beat();
        });
        recorded_bytes_ += records_[brick].bytes();
        sampler_bytes_ += pass.grown_by();
        if (recorded_bytes_ + sampler_bytes_ > run_.max_memory_bytes) pulse_.stop();
      });
}

bool Contouring::number_vertices() {
  for (std::size_t b = 0; b < bricks_; ++b) first_vertex_[b + 1] = first_vertex_[b] + records_[b].vertices;
  const std::uint64_t points = first_vertex_.back();
  if (points > sink_.max_points()) {
    diagnostics_.report(
        {.code = Code::limit_vertices, .args = {std::to_string(points), std::to_string(sink_.max_points())}});
    return false;
  }
  return fits(recorded_bytes_ + points * (sink_.bytes_per_point() + 2 * sink_.bytes_per_triangle()), "its surface");
}

bool Contouring::face_pass() {
  OrderedOutput output = this->output(&MeshSink::write_triangles);
  pulse_.begin("triangles");
  return for_each_brick(
      output, [&] { return FacePass(layout_, sink_); },
      [&](FacePass& pass, std::size_t brick, ByteBuffer& bytes) {
        const auto beside = [&](std::size_t b) -> BrickView::Neighbour {
          if (b >= bricks_) return {};
          return {&records_[b], first_plane(b), static_cast<std::uint32_t>(first_vertex_[b])};
        };
        const BrickView view{first_plane(brick), last_plane(brick),
                             &records_[brick],   static_cast<std::uint32_t>(first_vertex_[brick]),
                             beside(brick - 1),  beside(brick + 1)};
        triangles_ += pass.run(view, bytes, [&] {
          output.offer(brick, bytes);
          return pulse_.beat();
        });
      });
}

// Where the sink has failed, its owner reports.
std::nullopt_t Contouring::stopped() {
  if (fits(recorded_bytes_ + sampler_bytes_, "the record of its surface") && pulse_.stopped())
    diagnostics_.report({.code = pulse_.out_of_time() ? Code::limit_time : Code::cancelled});
  return std::nullopt;
}

std::optional<ContourReport> Contouring::run() {
  if (!sink_.begin() || !vertex_pass()) return stopped();
  sampler_bytes_ = 0;
  if (!number_vertices()) return std::nullopt;
  if (!sink_.begin_triangles(first_vertex_.back()) || !face_pass()) return stopped();
  if (!sink_.finish(triangles_)) return std::nullopt;
  ContourReport report;
  report.points = first_vertex_.back();
  report.triangles = triangles_;
  // Every edge lies in two triangles: there are 3/2 as many edges as triangles.
  report.euler = static_cast<std::int64_t>(report.points) - static_cast<std::int64_t>(report.triangles / 2);
  for (const BrickRecord& record : records_) report.undefined += record.undefined, report.inside += record.inside;
  return report;
}

bool check_nodes(const Grid& grid, DiagnosticSink& diagnostics) {
  // Crossings are numbered in 16 bits, the added layer included; rows of a brick in 32.
  constexpr std::array<std::int32_t, 3> most{65534, 1 << 24, 1 << 24};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    assert(grid.nodes[axis] >= 2);
    if (grid.nodes[axis] <= most[axis]) continue;
    diagnostics.report(
        {.code = Code::limit_grid,
         .args = {std::to_string(grid.nodes[axis]), std::string(1, "xyz"[axis]), std::to_string(most[axis])}});
    return false;
  }
  return true;
}

// A mesh that is worked on before it goes out.
class WorkingMesh final : public MemoryMeshSink {
 public:
  using MemoryMeshSink::MemoryMeshSink;
  // Growing vectors hold everything one and a half times; collapsing adds lists of corners and of short edges.
  [[nodiscard]] std::uint64_t bytes_per_point() const override { return sizeof(Vec3) * 3 / 2 + 20; }
  [[nodiscard]] std::uint64_t bytes_per_triangle() const override { return sizeof(IndexTriangle) * 3 / 2 + 32; }
};

std::optional<ContourReport> contour_without_slivers(const GridSource& source, MeshSink& sink,
                                                     const ContourOptions& options, const RunOptions& run,
                                                     DiagnosticSink& diagnostics) {
  TriangleMesh mesh;
  WorkingMesh working(mesh);
  auto report = Contouring(source, working, options, run, diagnostics).run();
  if (!report) return report;
  const Grid& grid = source.grid();
  run.report("slivers", 0);
  if (!collapse_slivers(mesh, grid.box, std::min({grid.spacing(0), grid.spacing(1), grid.spacing(2)}), run)) {
    diagnostics.report({.code = run.out_of_time() ? Code::limit_time : Code::cancelled});
    return std::nullopt;
  }
  report->points = mesh.points.size();
  report->triangles = mesh.triangles.size();
  if (!write_mesh(mesh, sink)) return std::nullopt;
  return report;
}

}  // namespace

bool check_grid(const Grid& grid, const RunOptions& run, DiagnosticSink& diagnostics) {
  return check_nodes(grid, diagnostics) && memory_fits(grid, false, 0, run, diagnostics);
}

std::optional<ContourReport> contour(const GridSource& source, MeshSink& sink, const ContourOptions& options,
                                     const RunOptions& run, DiagnosticSink& diagnostics) {
  if (!check_nodes(source.grid(), diagnostics)) return std::nullopt;
  if (!memory_fits(source.grid(), source.signs_only(), source.bytes(), run, diagnostics)) return std::nullopt;
  const auto start = std::chrono::steady_clock::now();
  auto report = options.collapse_slivers ? contour_without_slivers(source, sink, options, run, diagnostics)
                                         : Contouring(source, sink, options, run, diagnostics).run();
  if (report) report->seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
}

}  // namespace meso::implicit
