// SPDX-License-Identifier: Apache-2.0
// Coordinate systems of the document: placements multiplied down from the outermost parent, directions normalised.
#include <algorithm>
#include <cmath>

#include "evaluation_impl.hpp"
#include "meso/base/number.hpp"

namespace meso::eval {
namespace {

// sines of angles, so the same for every unit.
constexpr double independence_tolerance = 1e-9;
//
constexpr double rigidity_tolerance = 1e-9;

bool is_rigid(const Mat3& m) {
  const Mat3 gram = transposed(m) * m;
  for (std::size_t i = 0; i < 9; ++i) {
    if (std::abs(gram.m[i] - Mat3{}.m[i]) > rigidity_tolerance) return false;
  }
  return determinant(m) > 0;
}

/// What is left of `v` in the space that `basis`, orthonormal, does not span.
Vec3 remainder(Vec3 v, const std::vector<Vec3>& basis) {
  for (const Vec3& b : basis) v = v - dot(v, b) * b;
  return v;
}

struct FrameBuilder {
  const EvaluationData& data;
  Report report;

  std::optional<CoordinateAxis> axis(const Axis& a, std::vector<Vec3>& linear, std::vector<Vec3>& distance) const {
    CoordinateAxis result{a.name.text, a.kind, {}};
    if (a.kind == AxisKind::scalar) return result;
    const std::optional<Vec3> direction = data.vector(a, a.x, a.y, a.z, 0, report);
    if (!direction) return std::nullopt;
    const double length = norm(*direction);
    if (length == 0) {
      report(Code::direction_zero, {a.id_in_source, {}}, {});
      return std::nullopt;
    }
    result.direction = *direction / length;
    if (a.kind == AxisKind::circular) return result;
    std::vector<Vec3>& basis = a.kind == AxisKind::linear ? linear : distance;
    const Vec3 left = remainder(result.direction, basis);
    if (norm(left) < independence_tolerance) {
      report(Code::axes_dependent, {a.id_in_source, {}},
             {a.name.text, a.kind == AxisKind::linear ? "linear" : "distance"});
      return std::nullopt;
    }
    basis.push_back(left / norm(left));
    return result;
  }

  std::optional<CoordinateFrame> frame(const CoordinateSystem& system, const Affine& world_from_parent) const {
    Affine world_from_system = world_from_parent;
    if (system.placement) {
      const Place place{system.placement->id_in_source, "matrix"};
      const auto rows = data.values(system.placement->matrix, place, 12, report);
      if (!rows) return std::nullopt;
      std::array<double, 12> matrix{};
      std::copy(rows->begin(), rows->end(), matrix.begin());
      const Affine parent_from_system = Affine::from_rows(matrix);
      if (!is_rigid(parent_from_system.linear)) {
        report(Code::placement_not_rigid, place,
               {"its determinant is " + format_number(determinant(parent_from_system.linear))});
        return std::nullopt;
      }
      world_from_system = world_from_parent * parent_from_system;
    }
    std::vector<CoordinateAxis> axes;
    std::vector<Vec3> linear, distance;
    for (const Axis& a : system.axes) {
      auto one = axis(a, linear, distance);
      if (!one) return std::nullopt;
      axes.push_back(std::move(*one));
    }
    return CoordinateFrame(world_from_system, std::move(axes));
  }
};

}  // namespace

bool evaluate_frames(EvaluationData& data, DiagnosticSink& sink) {
  data.cartesian =
      std::make_shared<CoordinateFrame>(Affine{}, std::vector<CoordinateAxis>{{"x", AxisKind::linear, {1, 0, 0}},
                                                                              {"y", AxisKind::linear, {0, 1, 0}},
                                                                              {"z", AxisKind::linear, {0, 0, 1}}});
  const FrameBuilder builder{data, data.report(sink)};
  std::vector<const CoordinateSystem*> waiting;
  for (const CoordinateSystem& system : data.document().coordinate_systems) waiting.push_back(&system);
  // Parents first. The document is checked: there are no cycles, so every round makes progress.
  while (!waiting.empty()) {
    std::vector<const CoordinateSystem*> later;
    for (const CoordinateSystem* system : waiting) {
      const auto parent = system->parent ? data.frames.find(system->parent->text) : data.frames.end();
      if (system->parent && parent == data.frames.end()) {
        later.push_back(system);
        continue;
      }
      auto frame = builder.frame(*system, system->parent ? parent->second->world_from_system() : Affine{});
      if (!frame) return false;
      data.frames.emplace(system->id.text, std::make_shared<CoordinateFrame>(std::move(*frame)));
    }
    if (later.size() == waiting.size()) return false;
    waiting = std::move(later);
  }
  return true;
}

}  // namespace meso::eval
