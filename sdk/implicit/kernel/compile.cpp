// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/compile.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <set>
#include <string>

#include "bands.hpp"
#include "fit_floats.hpp"
#include "plan.hpp"
#include "point_values.hpp"
#include "separate.hpp"
#include "slab_plan.hpp"

namespace meso::implicit {
namespace {

// The usual number of planes at a time; only for judging whether pruning pays.
constexpr std::int32_t usual_slab = 8;

class Source final : public GridSource {
 public:
  Source(Graph graph, Graph::Id root, const Grid& grid, const CompileOptions& options)
      : plan_(std::move(graph), root, grid, row_kernels(options.instruction_set), options.max_table_bytes),
        bands_(external_bands(plan_.graph(), root)),
        prunes_(options.pruning == Pruning::on ||
                (options.pruning == Pruning::automatic && pruning_pays(plan_, usual_slab))) {}

  /// `bands`: what the signs of rows need. False if the run was stopped.
  [[nodiscard]] bool prepare(std::span<const Band> bands, const RunOptions& run) {
    for (std::size_t k = 0; k < bands.size(); ++k) {
      const ExternalLeaf& leaf = plan_.graph().externals()[k];
      const double band = bands[k].for_root(0);
      externals_.push_back(leaf.field->prepare(grid(), leaf.field_from_world, band, run));
      if (!externals_.back()) return false;
      if (!std::isfinite(band)) continue;
      signs_only_ = true;
      exact_within_ = std::min(exact_within_, bands[k].root_for(std::max(band, externals_.back()->exact_within())));
    }
    return true;
  }

  [[nodiscard]] const Grid& grid() const override { return plan_.grid(); }
  [[nodiscard]] std::unique_ptr<GridSampler> sampler() const override;
  [[nodiscard]] bool signs_only() const override { return signs_only_; }
  [[nodiscard]] double exact_within() const override { return exact_within_; }

  [[nodiscard]] std::uint64_t bytes() const override { return external_bytes_ + plan_.table_bytes(); }
  void count_externals(std::uint64_t bytes) { external_bytes_ = bytes; }

  [[nodiscard]] const Plan& plan() const { return plan_; }
  [[nodiscard]] bool prunes() const { return prunes_; }
  [[nodiscard]] PointValues point_values(std::vector<ExternalRows*> externals) const {
    return {plan_.points(), bands_, std::move(externals), reach()};
  }
  [[nodiscard]] std::vector<std::unique_ptr<ExternalRows>> external_rows() const {
    std::vector<std::unique_ptr<ExternalRows>> rows;
    for (const auto& external : externals_) rows.push_back(external->make_rows());
    return rows;
  }

 private:
  /// The root's magnitude that needs every external up to four cells: more than what is beside its surface.
  [[nodiscard]] double reach() const {
    double least = HUGE_VAL;
    for (std::size_t k = 0; k < bands_.size(); ++k) {
      const Mat3& map = plan_.graph().externals()[k].field_from_world.linear;
      double cell = 0;
      for (std::size_t axis = 0; axis < 3; ++axis)
        cell = std::max(cell, norm(map.column(axis)) * plan_.grid().spacing(axis));
      const double slope = bands_[k].for_root(1) - bands_[k].for_root(0);
      if (bands_[k].is_finite() && slope > 0) least = std::min(least, 4 * cell / slope);
    }
    return least;
  }

  Plan plan_;
  std::vector<Band> bands_;
  std::vector<std::unique_ptr<ExternalField::Prepared>> externals_;
  bool prunes_, signs_only_ = false;
  double exact_within_ = HUGE_VAL;
  std::uint64_t external_bytes_ = 0;
};

class Sampler final : public GridSampler {
 public:
  explicit Sampler(const Source& source)
      : plan_(source.plan()),
        plane_(plan_.plane_size()),
        plane_rows_(plan_.plane_rows(plane_.data())),
        plane_columns_(plan_.plane_columns(plane_.data())),
        external_rows_(source.external_rows()),
        external_pointers_(pointers(external_rows_)),
        points_(source.point_values(external_pointers_)),
        samples_(static_cast<std::size_t>(plan_.grid().nodes[0])) {
    if (source.prunes()) {
      slab_.emplace(plan_, [this](auto steps, auto stands_for) {
        return std::make_unique<Program>(rows_program(steps, stands_for));
      });
    } else {
      rows_.emplace(rows_program(plan_.nodes(Plan::Where::step), {}));
    }
  }

  void begin_slab(std::int32_t first, std::int32_t last) override {
    if (slab_) slab_->enter_slab(first, last);
  }

  void row(std::int32_t j, std::int32_t k, float* values, std::uint64_t* inside) override {
    enter_plane(k);
    auto* const bits = reinterpret_cast<std::uint16_t*>(inside);  // row_unit samples each; x86 is little-endian
    if (slab_) {
      const RowPlan& row = slab_->of_row(j);
      std::copy(row.inside.begin(), row.inside.end(), bits);
      for (const Run& run : row.runs)
        run.program->sample(run.begin, run.end, std::size_t(j), std::size_t(k), values, bits);
    } else {
      rows_->sample(0, padded(samples_), std::size_t(j), std::size_t(k), values, bits);
    }
    const std::size_t last = samples_ / row_unit;
    for (std::size_t unit = last; unit < padded(samples_) / row_unit; ++unit)
      bits[unit] = unit == last ? bits[unit] & ((1U << samples_ % row_unit) - 1) : 0;
  }

  void values_at(std::span<const Vec3> points, double* out) override { points_.values_at(points, out); }

 private:
  static std::vector<ExternalRows*> pointers(const std::vector<std::unique_ptr<ExternalRows>>& rows) {
    std::vector<ExternalRows*> result;
    for (const auto& r : rows) result.push_back(r.get());
    return result;
  }
  Program rows_program(std::span<const Graph::Id> steps, std::span<const Graph::Id> stands_for) {
    return plan_.rows(steps, plane_.data(), {external_pointers_, samples_}, stands_for);
  }

  void enter_plane(std::int32_t k) {
    if (k == in_plane_) return;
    in_plane_ = k;
    plane_rows_.run(0, padded(samples_), 0, std::size_t(k));
    plane_columns_.run(0, padded(static_cast<std::size_t>(plan_.grid().nodes[1])), 0, std::size_t(k));
  }

  const Plan& plan_;
  AlignedArray plane_;
  Program plane_rows_, plane_columns_;
  std::vector<std::unique_ptr<ExternalRows>> external_rows_;
  std::vector<ExternalRows*> external_pointers_;
  PointValues points_;
  std::size_t samples_;
  std::optional<Program> rows_;
  std::optional<SlabPlan> slab_;
  std::int32_t in_plane_ = -1;
};

std::unique_ptr<GridSampler> Source::sampler() const { return std::make_unique<Sampler>(*this); }

}  // namespace

namespace {

/// What external fields hold, each once, and take for the grid.
std::uint64_t bytes_of_externals(const Graph& graph, const Grid& grid) {
  std::set<const ExternalField*> seen;
  std::uint64_t bytes = 0;
  for (const ExternalLeaf& leaf : graph.externals()) {
    if (seen.insert(leaf.field.get()).second) bytes += leaf.field->bytes();
    bytes += leaf.field->prepared_bytes(grid);
  }
  return bytes;
}

}  // namespace

std::unique_ptr<GridSource> compile(const Term& term, const Grid& grid, const CompileOptions& options,
                                    const RunOptions& run, DiagnosticSink& sink) {
  assert(grid.nodes[0] >= 2 && grid.nodes[1] >= 2 && grid.nodes[2] >= 2);
  Graph graph;
  Graph::Id root = graph.from_term(term);
  CompileOptions within_budget = options;
  within_budget.max_table_bytes = std::min(options.max_table_bytes, run.max_memory_bytes / 4);
  const std::uint64_t bytes = bytes_of_externals(graph, grid);
  if (!fits_memory(grid, bytes, "the meshes in it", run, sink)) return nullptr;
  const std::vector<Band> bands = external_bands(graph, root);
  if (!options.strict_math) root = separate(graph, root, grid);
  root = fit_to_floats(graph, root, term, grid);
  if (!run.should_stop()) {
    auto source = std::make_unique<Source>(std::move(graph), root, grid, within_budget);
    source->count_externals(bytes);
    if (source->prepare(bands, run)) return source;
  }
  sink.report({.code = run.out_of_time() ? Code::limit_time : Code::cancelled});
  return nullptr;
}

std::unique_ptr<GridSource> compile(const Term& term, const Grid& grid, const CompileOptions& options) {
  DiagnosticSink nothing_can_fail;
  return compile(term, grid, options, {.max_memory_bytes = ~std::uint64_t{0}}, nothing_can_fail);
}

void values(const Term& term, std::span<const Vec3> points, double* out, InstructionSet set) {
  Graph graph;
  const Graph::Id root = graph.from_term(term);
  const Plan plan(std::move(graph), root, Grid{.box = {{0, 0, 0}, {1, 1, 1}}}, row_kernels(set), 0);
  plan.points().values_at(points, {}, out);
}

}  // namespace meso::implicit
