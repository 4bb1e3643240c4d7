// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/compile.hpp"

#include <cassert>
#include <cstring>

#include "plan.hpp"
#include "separate.hpp"

namespace meso::implicit {
namespace {

class Source final : public GridSource {
 public:
  explicit Source(Graph graph, Graph::Id root, const Grid& grid, const RowKernels& kernels, std::uint64_t table_bytes)
      : plan_(std::move(graph), root, grid, kernels, table_bytes), steps_(plan_.nodes(Plan::Where::step)) {}

  [[nodiscard]] const Grid& grid() const override { return plan_.grid(); }
  [[nodiscard]] std::unique_ptr<GridSampler> sampler() const override;

  [[nodiscard]] const Plan& plan() const { return plan_; }
  [[nodiscard]] const std::vector<Graph::Id>& steps() const { return steps_; }

 private:
  Plan plan_;
  std::vector<Graph::Id> steps_;
};

class Sampler final : public GridSampler {
 public:
  explicit Sampler(const Source& source)
      : plan_(source.plan()),
        plane_(plan_.plane_size()),
        plane_rows_(plan_.plane_rows(plane_.data())),
        plane_columns_(plan_.plane_columns(plane_.data())),
        rows_(plan_.rows(source.steps(), plan_.root(), plane_.data(), {})),
        points_(plan_.points()),
        samples_(static_cast<std::size_t>(plan_.grid().nodes[0])) {}

  void begin_slab(std::int32_t, std::int32_t) override {}

  void row(std::int32_t j, std::int32_t k, float* values, std::uint64_t* inside) override {
    enter_plane(k);
    rows_.sample(0, padded(samples_), std::size_t(j), std::size_t(k), values, reinterpret_cast<std::uint16_t*>(inside));
    if (samples_ % 64 != 0) inside[samples_ / 64] &= (std::uint64_t{1} << samples_ % 64) - 1;
  }

  void values_at(std::span<const Vec3> points, double* out) override { points_.values_at(points, out); }

 private:
  void enter_plane(std::int32_t k) {
    if (k == in_plane_) return;
    in_plane_ = k;
    plane_rows_.run(0, padded(samples_), 0, std::size_t(k));
    plane_columns_.run(0, padded(static_cast<std::size_t>(plan_.grid().nodes[1])), 0, std::size_t(k));
  }

  const Plan& plan_;
  AlignedArray plane_;
  Program plane_rows_, plane_columns_, rows_, points_;
  std::size_t samples_;
  std::int32_t in_plane_ = -1;
};

std::unique_ptr<GridSampler> Source::sampler() const { return std::make_unique<Sampler>(*this); }

}  // namespace

std::unique_ptr<GridSource> compile(const Term& term, const Grid& grid, const CompileOptions& options) {
  Graph graph;
  Graph::Id root = graph.from_term(term);
  if (!options.strict_math) root = separate(graph, root, grid);
  return std::make_unique<Source>(std::move(graph), root, grid, row_kernels(options.instruction_set),
                                  options.max_table_bytes);
}

void values(const Term& term, std::span<const Vec3> points, double* out, InstructionSet set) {
  Graph graph;
  const Graph::Id root = graph.from_term(term);
  const Plan plan(std::move(graph), root, Grid{.box = {{0, 0, 0}, {1, 1, 1}}}, row_kernels(set), 0);
  plan.points().values_at(points, out);
}

}  // namespace meso::implicit
