// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/point_program.hpp"

#include <mutex>
#include <vector>

#include "plan.hpp"

namespace meso::implicit {
namespace {

Plan plan_of(const Term& term) {
  Graph graph;
  const Graph::Id root = graph.from_term(term);
  return {std::move(graph), root, Grid{.box = {{0, 0, 0}, {1, 1, 1}}}, row_kernels(InstructionSet::automatic), 0};
}

}  // namespace

/// A program has room for intermediate values: each is run by one thread at a time.
struct PointProgram::Shared {
  explicit Shared(const Term& term) : plan(plan_of(term)) {}

  std::unique_ptr<Program> take() {
    {
      const std::lock_guard lock(mutex);
      if (!idle.empty()) {
        auto program = std::move(idle.back());
        idle.pop_back();
        return program;
      }
    }
    return std::make_unique<Program>(plan.points());
  }
  void give_back(std::unique_ptr<Program> program) {
    const std::lock_guard lock(mutex);
    idle.push_back(std::move(program));
  }

  Plan plan;
  std::mutex mutex;
  std::vector<std::unique_ptr<Program>> idle;
};

PointProgram::PointProgram(const Term& term) : shared_(std::make_unique<Shared>(term)) {}
PointProgram::PointProgram(PointProgram&&) noexcept = default;
PointProgram& PointProgram::operator=(PointProgram&&) noexcept = default;
PointProgram::~PointProgram() = default;

void PointProgram::values(std::span<const Vec3> points, double* out) const {
  auto program = shared_->take();
  program->values_at(points, {}, out);
  shared_->give_back(std::move(program));
}

}  // namespace meso::implicit
