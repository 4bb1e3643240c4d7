// SPDX-License-Identifier: Apache-2.0
#pragma once
// Surfaces and curves as STEP entities, where an instance of a template stands.

#include <unordered_map>

#include "meso/brep/body.hpp"
#include "step_text.hpp"

namespace meso::step {

/// Where one shell stands, and one cell of it: lattice translation, then a rotation, scaling and shift.
class Pose {
 public:
  explicit Pose(const brep::Shell& shell);
  void set_cell(const brep::Index3& cell);

  [[nodiscard]] Vec3 point(Vec3 p) const { return placement_ * (p + cell_origin_); }
  [[nodiscard]] Vec3 direction(Vec3 d) const { return rotation_ * d; }
  [[nodiscard]] double length(double l) const { return scale_ * l; }

 private:
  const brep::Template& geometry_;
  Affine placement_;
  double scale_ = 1;
  Mat3 rotation_;
  Vec3 cell_origin_;
};

/// The numbers of directions and of vectors along them. Lattices repeat few; beyond a bound, so that a million rotated
/// cells need no memory, a direction is written each time.
class Directions {
 public:
  struct Ids {
    StepId direction = 0, vector = 0;
  };
  /// Null: it is not kept.
  [[nodiscard]] const Ids* find(Vec3 unit) const;
  [[nodiscard]] Ids* find_or_add(Vec3 unit);

 private:
  struct Hash {
    std::size_t operator()(const Vec3& v) const;
  };
  std::unordered_map<Vec3, Ids, Hash> ids_;
};

class StepGeometry {
 public:
  /// Numbers the directions that it writes.
  StepGeometry(StepText& text, Directions& numbers) : text_(text), growing_(&numbers), known_(numbers) {}
  /// Directions have been numbered: what has a number beyond the last one written is to be written now.
  StepGeometry(StepText& text, const Directions& numbers) : text_(text), known_(numbers) {}

  [[nodiscard]] StepId point(Vec3 placed) { return text_.entity("CARTESIAN_POINT", NoName{}, placed); }
  [[nodiscard]] StepId surface(const brep::Surface& surface, const Pose& pose);
  [[nodiscard]] StepId curve(const brep::Curve& curve, const Pose& pose);

 private:
  [[nodiscard]] StepId direction(Vec3 unit);
  [[nodiscard]] StepId vector(Vec3 unit);
  [[nodiscard]] StepId frame(const brep::AxisFrame& frame, const Pose& pose);
  [[nodiscard]] std::vector<StepId> points(const std::vector<Vec3>& poles, const Pose& pose);

  [[nodiscard]] StepId write(const brep::Plane& s, const Pose& pose);
  [[nodiscard]] StepId write(const brep::CylinderSurface& s, const Pose& pose);
  [[nodiscard]] StepId write(const brep::ConeSurface& s, const Pose& pose);
  [[nodiscard]] StepId write(const brep::SphereSurface& s, const Pose& pose);
  [[nodiscard]] StepId write(const brep::TorusSurface& s, const Pose& pose);
  [[nodiscard]] StepId write(const brep::BSplineSurface& s, const Pose& pose);
  [[nodiscard]] StepId write(const brep::Line& c, const Pose& pose);
  [[nodiscard]] StepId write(const brep::Circle& c, const Pose& pose);
  [[nodiscard]] StepId write(const brep::Ellipse& c, const Pose& pose);
  [[nodiscard]] StepId write(const brep::BSplineCurve& c, const Pose& pose);

  template <typename Write>
  StepId once(Vec3 unit, StepId Directions::Ids::*id, Write write);

  StepText& text_;
  Directions* growing_ = nullptr;
  const Directions& known_;
};

}  // namespace meso::step
