// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/accurate_mesh.hpp"

#include <algorithm>
#include <cmath>

#include "meso/base/memory_mesh_sink.hpp"
#include "meso/base/number.hpp"
#include "refine_mesh.hpp"
#include "simplify_mesh.hpp"

namespace meso::implicit {
namespace {

double largest_spacing(const Grid& grid) { return std::max({grid.spacing(0), grid.spacing(1), grid.spacing(2)}); }

Grid with_spacing(const Box3& box, double spacing) {
  Grid grid{.box = box};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double cells = std::ceil((box.max[axis] - box.min[axis]) / spacing - 1e-6);
    grid.nodes[axis] = static_cast<std::int32_t>(std::clamp(cells + 1, 2.0, 2e9));
  }
  return grid;
}

/// A mesh in memory counts as such.
class WorkingMesh final : public MemoryMeshSink {
 public:
  using MemoryMeshSink::MemoryMeshSink;
  [[nodiscard]] std::uint64_t bytes_per_triangle() const override { return RefinableMesh::bytes_per_triangle; }
};

class Making {
 public:
  Making(const SourceOn& source_on, const AccurateMeshOptions& options, const RunOptions& run,
         DiagnosticSink& diagnostics)
      : source_on_(source_on), options_(options), run_(run), diagnostics_(diagnostics) {}

  std::optional<AccurateMesh> make(Grid grid);

 private:
  bool contour_on(const Grid& grid);
  bool to_tolerance(const Grid& first);
  [[nodiscard]] bool is_affordable(const Grid& coarse);
  bool resolve(Grid grid);
  bool refine();
  bool simplify();
  void measure(TriangleMesh mesh, bool may_move, double tolerance);
  [[nodiscard]] bool fits(double triangles);
  bool go_on();
  [[nodiscard]] std::function<bool()> not_stopped() const {
    return [this] { return !run_.should_stop(); };
  }

  const SourceOn& source_on_;
  const AccurateMeshOptions& options_;
  const RunOptions& run_;
  DiagnosticSink& diagnostics_;
  AccurateMesh out_;
  std::unique_ptr<GridSource> source_;
  std::optional<SurfaceFeet> feet_;
  std::optional<RefinableMesh> refinable_;
};

bool Making::go_on() {
  if (!run_.should_stop()) return true;
  diagnostics_.report({.code = run_.out_of_time() ? Code::limit_time : Code::cancelled});
  return false;
}

bool Making::contour_on(const Grid& grid) {
  if (feet_) out_.surface_samples += feet_->asked();
  refinable_.reset();
  feet_.reset();
  if (!check_grid(grid, run_, diagnostics_)) return false;
  source_ = source_on_(grid);  // only now: the feet were asked of the one before
  if (!source_) return false;
  out_.grid = grid;
  out_.grid_samples += grid.node_count();
  out_.mesh = {};
  WorkingMesh sink(out_.mesh);
  const auto report = contour(*source_, sink, {.polish = true, .sharp = options_.sharp}, run_, diagnostics_);
  if (!report) return false;
  out_.euler = report->euler;
  feet_.emplace(*source_, not_stopped());
  return true;
}

void Making::measure(TriangleMesh mesh, bool may_move, double tolerance) {
  refinable_.emplace(std::move(mesh), out_.grid.box, *feet_);
  if (may_move) refinable_->move_vertices(tolerance);
  refinable_->measure(tolerance);
}

bool Making::fits(double triangles) {
  const double bytes = triangles * static_cast<double>(RefinableMesh::bytes_per_triangle);
  if (bytes <= static_cast<double>(run_.max_memory_bytes)) return true;
  diagnostics_.report(
      {.code = Code::limit_tolerance,
       .args = {format_number(options_.tolerance), format_number(std::round(triangles)),
                format_number(std::ceil(bytes / (1 << 20))), std::to_string(run_.max_memory_bytes >> 20)}});
  return false;
}

// Before the work begins: how far middles of edges of a coarse mesh are from the surface, at a few of them, tells how
// many triangles a tolerance takes, to within some factor. Refused is what is beyond the budget by more than that.
bool Making::is_affordable(const Grid& coarse) {
  constexpr std::size_t asked = 200;
  constexpr double unsure = 8;
  if (!check_grid(coarse, run_, diagnostics_)) return false;
  const auto source = source_on_(coarse);
  if (!source) return false;
  TriangleMesh mesh;
  MemoryMeshSink sink(mesh);
  if (!contour(*source, sink, {}, run_, diagnostics_)) return false;
  out_.grid_samples += coarse.node_count();
  std::vector<PointNearSurface> middles;
  const std::size_t step = mesh.triangles.size() / asked + 1;
  for (std::size_t t = 0; t < mesh.triangles.size(); t += step) {
    const Vec3 a = mesh.points[mesh.triangles[t][0]], b = mesh.points[mesh.triangles[t][1]];
    if (planes_of(coarse.box, a) == 0 && planes_of(coarse.box, b) == 0) middles.push_back({(a + b) / 2, 0, 0});
  }
  if (middles.empty()) return true;
  SurfaceFeet feet(*source, not_stopped());
  std::vector<double> distances;
  feet.distances(middles, 0.01 * largest_spacing(coarse), distances);
  out_.surface_samples += feet.asked();
  if (!go_on()) return false;
  double times = 0;
  for (const double d : distances) times += std::max(1.0, d / options_.tolerance);
  const double triangles = times / static_cast<double>(middles.size()) * static_cast<double>(mesh.triangles.size());
  return triangles * static_cast<double>(RefinableMesh::bytes_per_triangle) <=
             unsure * static_cast<double>(run_.max_memory_bytes) ||
         fits(triangles);
}

// The coarsest of grids, each twice as fine as the one before, on which few edges are farther from the surface than a
// quarter of a cell: where a mesh is that close, it turns where the surface turns.
bool Making::resolve(Grid grid) {
  constexpr double near = 0.25, few = 2e-3;
  constexpr int most_halvings_of_nothing = 3;
  for (int halvings = 0;; ++halvings) {
    const double spacing = largest_spacing(grid);
    if (!contour_on(grid)) return false;
    const bool empty = out_.mesh.triangles.empty();
    measure(std::move(out_.mesh), true, options_.tolerance);
    if (!go_on()) return false;
    const bool seen = !empty && refinable_->share_beyond(std::max(near * spacing, options_.tolerance)) <= few;
    if (seen || (empty && halvings == most_halvings_of_nothing)) return true;
    // Where the field has kinks that no grid resolves, a finer one only costs: what it would add, refining adds where
    // it is needed.
    const auto triangles = static_cast<double>(refinable_->mesh().triangles.size());
    if (!empty && 4 * triangles > refinable_->triangles_for(options_.tolerance)) return true;
    grid = with_spacing(grid.box, spacing / 2);
  }
}

bool Making::refine() {
  constexpr int most_rounds = 24;
  for (int round = 0; round < most_rounds; ++round) {
    run_.report("refining", static_cast<double>(round) / most_rounds);
    if (!fits(std::max(refinable_->triangles_for(options_.tolerance),
                       static_cast<double>(refinable_->mesh().triangles.size()))))
      return false;
    if (refinable_->refine(options_.tolerance) == 0) break;
    refinable_->measure(options_.tolerance);
    if (!go_on()) return false;
  }
  return go_on();
}

bool Making::to_tolerance(const Grid& first) {
  const Vec3 size = first.box.max - first.box.min;
  const double longest = std::max({size.x, size.y, size.z});
  // No coarser than what a feature takes to be seen, nor so coarse that a plain shape is lost.
  const double spacing =
      options_.smallest_feature > 0 ? std::min(options_.smallest_feature, longest / 16) : longest / 32;
  if (!is_affordable(with_spacing(first.box, longest / 16))) return false;
  if (!resolve(with_spacing(first.box, spacing)) || !refine()) return false;
  out_.distance = refinable_->distance();
  if (out_.distance > options_.tolerance)
    diagnostics_.report({.code = Code::tolerance_not_reached,
                         .args = {format_number(out_.distance), format_number(options_.tolerance)}});
  out_.mesh = refinable_->take();
  return true;
}

// What the planes of triangles promise is measured; where it does not hold, once more from the start with less.
bool Making::simplify() {
  const TriangleMesh whole = std::move(out_.mesh);
  double bound = options_.simplify;
  for (int attempt = 0; attempt < 6; ++attempt) {
    run_.report("simplifying", attempt / 6.0);
    TriangleMesh mesh = whole;
    if (!simplify_mesh(mesh, out_.grid.box, bound, run_)) return go_on();
    measure(std::move(mesh), false, options_.simplify);
    if (!go_on()) return false;
    out_.distance = refinable_->distance();
    out_.mesh = refinable_->take();
    if (out_.distance <= options_.simplify) return true;
    bound *= std::clamp(0.95 * options_.simplify / out_.distance, 0.2, 0.6);
  }
  diagnostics_.report(
      {.code = Code::tolerance_not_reached, .args = {format_number(out_.distance), format_number(options_.simplify)}});
  return true;
}

std::optional<AccurateMesh> Making::make(Grid grid) {
  if (options_.tolerance > 0) {
    if (!to_tolerance(grid)) return std::nullopt;
  } else {
    if (!contour_on(grid)) return std::nullopt;
  }
  if (options_.simplify > 0 && !out_.mesh.triangles.empty() && !simplify()) return std::nullopt;
  if (feet_) out_.surface_samples += feet_->asked();
  return std::move(out_);
}

}  // namespace

std::optional<AccurateMesh> make_accurate_mesh(const SourceOn& source_on, const Grid& grid,
                                               const AccurateMeshOptions& options, const RunOptions& run,
                                               DiagnosticSink& diagnostics) {
  return Making(source_on, options, run, diagnostics).make(grid);
}

}  // namespace meso::implicit
