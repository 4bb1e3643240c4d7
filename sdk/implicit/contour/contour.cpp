// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/contour.hpp"

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <atomic>

#include "face_pass.hpp"
#include "ordered_output.hpp"
#include "pulse.hpp"
#include "vertex_pass.hpp"

namespace meso::implicit {
namespace {

// With the plane below it, a slab of 16.
constexpr std::size_t brick_planes = 15;

class Contouring {
 public:
  Contouring(const GridSource& source, MeshSink& sink, const RunOptions& run, DiagnosticSink& diagnostics)
      : source_(source),
        sink_(sink),
        diagnostics_(diagnostics),
        layout_(source.grid()),
        bricks_((layout_.nz + brick_planes) / brick_planes),
        jobs_(jobs_of(run, bricks_)),
        records_(bricks_),
        first_vertex_(bricks_ + 1),
        pulse_(run, (layout_.nz + 1) * (layout_.ny + 1)) {}

  std::optional<ContourReport> run();

 private:
  template <class Pass, class Brick>
  bool for_each_brick(OrderedOutput& output, Pass make_pass, Brick do_brick);
  bool vertex_pass();
  bool number_vertices();
  bool face_pass();
  std::nullopt_t stopped();

  [[nodiscard]] std::size_t first_plane(std::size_t brick) const { return brick * brick_planes; }
  [[nodiscard]] std::size_t last_plane(std::size_t brick) const {
    return std::min(first_plane(brick) + brick_planes, layout_.nz + 1);
  }
  static std::size_t jobs_of(const RunOptions& run, std::size_t bricks) {
    const auto cores = static_cast<std::size_t>(tbb::info::default_concurrency());
    return std::min(bricks, run.jobs == 0 ? cores : std::size_t{run.jobs});
  }

  const GridSource& source_;
  MeshSink& sink_;
  DiagnosticSink& diagnostics_;
  Layout layout_;
  std::size_t bricks_, jobs_;
  std::vector<BrickRecord> records_;
  std::vector<std::uint64_t> first_vertex_;
  std::atomic<std::uint64_t> triangles_{0};
  Pulse pulse_;
};

// Bricks are handed out in ascending order, so that what the output waits for is always being worked on.
template <class Pass, class Brick>
bool Contouring::for_each_brick(OrderedOutput& output, Pass make_pass, Brick do_brick) {
  std::atomic<std::size_t> ticket{0};
  const auto work = [&](std::size_t) {
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
  tbb::task_arena arena(static_cast<int>(jobs_));
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, jobs_, work, tbb::simple_partitioner{}); });
  return !pulse_.stopped() && !output.failed();
}

bool Contouring::vertex_pass() {
  OrderedOutput output([&](std::string_view bytes) { return sink_.write_points(bytes); }, 2 * jobs_);
  pulse_.begin("vertices");
  return for_each_brick(
      output, [&] { return VertexPass(layout_, source_.sampler(), sink_); },
      [&](VertexPass& pass, std::size_t brick, ByteBuffer& bytes) {
        records_[brick] = pass.run(first_plane(brick), last_plane(brick), bytes, [&] {
          output.offer(brick, bytes);
          return pulse_.beat();
        });
      });
}

bool Contouring::number_vertices() {
  for (std::size_t b = 0; b < bricks_; ++b) first_vertex_[b + 1] = first_vertex_[b] + records_[b].vertices;
  if (first_vertex_.back() <= sink_.max_points()) return true;
  diagnostics_.report({.code = Code::limit_vertices,
                       .args = {std::to_string(first_vertex_.back()), std::to_string(sink_.max_points())}});
  return false;
}

bool Contouring::face_pass() {
  OrderedOutput output([&](std::string_view bytes) { return sink_.write_triangles(bytes); }, 2 * jobs_);
  pulse_.begin("triangles");
  return for_each_brick(
      output, [&] { return FacePass(layout_, sink_); },
      [&](FacePass& pass, std::size_t brick, ByteBuffer& bytes) {
        const BrickView view{first_plane(brick), last_plane(brick), &records_[brick],
                             static_cast<std::uint32_t>(first_vertex_[brick]),
                             brick == 0 ? nullptr : &records_[brick - 1]};
        triangles_ += pass.run(view, bytes, [&] {
          output.offer(brick, bytes);
          return pulse_.beat();
        });
      });
}

// Where the sink has failed, its owner reports.
std::nullopt_t Contouring::stopped() {
  if (pulse_.stopped()) diagnostics_.report({.code = pulse_.out_of_time() ? Code::limit_time : Code::cancelled});
  return std::nullopt;
}

std::optional<ContourReport> Contouring::run() {
  if (!sink_.begin() || !vertex_pass()) return stopped();
  if (!number_vertices()) return std::nullopt;
  if (!sink_.begin_triangles(first_vertex_.back()) || !face_pass()) return stopped();
  if (!sink_.finish(triangles_)) return std::nullopt;
  ContourReport report;
  report.points = first_vertex_.back();
  report.triangles = triangles_;
  // Every edge lies in two triangles: there are 3/2 as many edges as triangles.
  report.euler = static_cast<std::int64_t>(report.points) - static_cast<std::int64_t>(report.triangles / 2);
  for (const BrickRecord& record : records_) report.undefined += record.undefined;
  return report;
}

}  // namespace

std::optional<ContourReport> contour(const GridSource& source, MeshSink& sink, const ContourOptions&,
                                     const RunOptions& run, DiagnosticSink& diagnostics) {
  const auto start = std::chrono::steady_clock::now();
  auto report = Contouring(source, sink, run, diagnostics).run();
  if (report) report->seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
}

}  // namespace meso::implicit
