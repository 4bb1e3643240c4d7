// SPDX-License-Identifier: Apache-2.0
#include "meso/operations/macrostructure_distance.hpp"

#include "meso/brep/realise.hpp"
#include "meso/brep/triangle_mesh.hpp"
#include "meso/operations/convert.hpp"
#ifdef MESO_WITH_MESH_DISTANCE
#include "meso/mesh_distance/mesh_field.hpp"
#endif

namespace meso::operations {

#ifdef MESO_WITH_MESH_DISTANCE
namespace {

constexpr double relative_deflection = 1e-4;

Box3 box_of(const TriangleMesh& mesh) {
  Box3 box;
  for (const Vec3& p : mesh.points) box.extend(p);
  return box;
}

class MeshWall final : public eval::MacrostructureDistance {
 public:
  MeshWall(std::shared_ptr<const implicit::MeshField> field, double size) : field_(std::move(field)), size_(size) {}

  Answer at(Vec3 p) const override {
    const double d = field_->value(p);
    const Vec3 away = p - field_->closest_point(p);
    // On the surface itself the way there has no direction: the one of the distance around has.
    if (norm(away) > 1e-9 * size_) return {d, (d < 0 ? -1 : 1) / norm(away) * away, std::nullopt};
    const double step = 1e-6 * size_;
    Vec3 slope;
    for (std::size_t i = 0; i < 3; ++i) {
      Vec3 e;
      e[i] = step;
      slope[i] = field_->value(p + e) - field_->value(p - e);
    }
    return {d, norm(slope) > 0 ? slope / norm(slope) : Vec3{0, 0, 1}, std::nullopt};
  }

 private:
  std::shared_ptr<const implicit::MeshField> field_;
  double size_;
};

}  // namespace

eval::FindMacrostructureDistance macrostructure_distance(std::vector<eval::Override> overrides, RunOptions run) {
  return [overrides = std::move(overrides), run](
             const CheckedDocument& checked, const Macrostructure& macrostructure,
             DiagnosticSink& sink) -> std::shared_ptr<const eval::MacrostructureDistance> {
    const auto evaluation = eval::Evaluation::make(checked, {.overrides = overrides, .run = run}, sink);
    if (!evaluation) return nullptr;
    // Coarsely for the size, then as finely as that asks for.
    brep::RealiseOptions options{.mesh = true, .deflection_mm = 1, .angle_rad = 0.5, .run = run};
    const auto coarse = brep::realise_macrostructure(*evaluation, macrostructure, options, sink);
    if (!coarse) return nullptr;
    const Box3 box = box_of(brep::triangle_mesh(*coarse));
    const double size = norm(box.max - box.min);
    options.deflection_mm = relative_deflection * size;
    options.angle_rad = 0.1;
    const auto body = brep::realise_macrostructure(*evaluation, macrostructure, options, sink);
    if (!body) return nullptr;
    auto field = implicit::MeshField::make(brep::triangle_mesh(*body), macrostructure.id.text, run, sink);
    return field ? std::make_shared<MeshWall>(std::move(field), size) : nullptr;
  };
}
#else
eval::FindMacrostructureDistance macrostructure_distance(std::vector<eval::Override>, RunOptions) { return {}; }
#endif

}  // namespace meso::operations
