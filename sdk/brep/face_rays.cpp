// SPDX-License-Identifier: Apache-2.0
#include "face_rays.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <gp_Lin.hxx>

#include "boolean.hpp"
#include "face_moments.hpp"
#include "solid_primitive.hpp"

namespace meso::brep {
namespace {

/// Two frames of lines along which no body has its faces.
constexpr std::array<std::array<Vec3, 3>, 2> frames{{
    {{{0.7360, 0.5370, 0.4120}, {-0.6600, 0.6850, 0.2850}, {-0.1300, -0.4810, 0.8670}}},
    {{{0.3710, -0.8230, 0.4290}, {0.8770, 0.1910, -0.4410}, {0.2820, 0.5330, 0.7970}}},
}};

bool may_meet(const Box3& box, Vec3 p, Vec3 direction, double margin) {
  double from = -margin, to = HUGE_VAL;
  for (std::size_t a = 0; a < 3; ++a) {
    const double low = (box.min[a] - margin - p[a]) / direction[a], high = (box.max[a] + margin - p[a]) / direction[a];
    from = std::max(from, std::min(low, high));
    to = std::min(to, std::max(low, high));
  }
  return from <= to;
}

}  // namespace

FaceRays::FaceRays(const TopoDS_Shape& solid) {
  for (TopExp_Explorer it(solid, TopAbs_FACE); it.More(); it.Next()) {
    const TopoDS_Face& face = TopoDS::Face(it.Current());
    faces_.push_back({std::make_unique<IntCurvesFace_Intersector>(face, Precision::Confusion()), face_box(face)});
  }
}

std::optional<TopAbs_State> FaceRays::state(Vec3 p, double tolerance_mm) {
  for (const auto& frame : frames) {
    int votes = 0;
    for (const Vec3& direction : frame) {
      const TopAbs_State state = along(p, direction / norm(direction), tolerance_mm);
      if (state == TopAbs_ON) return TopAbs_ON;
      if (state != TopAbs_UNKNOWN) votes += state == TopAbs_IN ? 1 : -1;
    }
    if (votes != 0) return votes > 0 ? TopAbs_IN : TopAbs_OUT;
  }
  return {};
}

/// TopAbs_UNKNOWN where the ray passes an edge or touches a face.
TopAbs_State FaceRays::along(Vec3 p, Vec3 direction, double tolerance_mm) {
  const double near = 2 * tolerance_mm;  // one of three lines is no steeper to a face than that
  const gp_Lin line(to_pnt(p), to_dir(direction));
  bool is_inside = false, is_clear = true;
  for (Face& face : faces_) {
    if (!may_meet(face.box, p, direction, near + Precision::Confusion())) continue;
    face.hits->Perform(line, -near, Precision::Infinite());
    if (!face.hits->IsDone()) return TopAbs_UNKNOWN;
    for (int i = 1; i <= face.hits->NbPnt(); ++i) {
      const TopAbs_State state = face.hits->State(i);
      if (state != TopAbs_IN && state != TopAbs_ON) continue;
      if (std::fabs(face.hits->WParameter(i)) <= near) return TopAbs_ON;
      if (face.hits->WParameter(i) < 0) continue;
      is_clear = is_clear && state == TopAbs_IN && face.hits->Transition(i) != IntCurveSurface_Tangent;
      is_inside = !is_inside;
    }
  }
  return !is_clear ? TopAbs_UNKNOWN : is_inside ? TopAbs_IN : TopAbs_OUT;
}

}  // namespace meso::brep
