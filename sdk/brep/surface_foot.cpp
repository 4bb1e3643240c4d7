// SPDX-License-Identifier: Apache-2.0
#include "surface_foot.hpp"

#include <ShapeAnalysis_Surface.hxx>
#include <cmath>

#include "surface_point.hpp"
#include "value_geometry.hpp"

namespace meso::brep {
namespace {

constexpr double search_tolerance = 1e-9;
constexpr int first_starts = 12;
constexpr std::size_t most_known = 512;  // looking through them is a hundredth of a search from anywhere

}  // namespace

// Newton's method for the zero of the derivatives of |S(u, v) - p|^2 / 2; where that is not convex, as beside a pole, a
// damped step of Gauss and Newton, which goes downhill anywhere.
std::optional<gp_Pnt2d> foot_beside(ShapeAnalysis_Surface& surface, const gp_Pnt2d& start, Vec3 p) {
  constexpr int most_steps = 16;
  constexpr double flat = 1e-10;  // of the angle between the parameter lines
  constexpr double damping = 1e-3;
  double first[2], last[2];
  surface.Bounds(first[0], last[0], first[1], last[1]);
  const auto is_closed = [&](int i) {
    return i == 0 ? surface.Surface()->IsUClosed() : surface.Surface()->IsVClosed();
  };
  double uv[2] = {start.X(), start.Y()};
  for (int n = 0; n < most_steps; ++n) {
    gp_Pnt s;
    gp_Vec su, sv, suu, svv, suv;
    surface.Adaptor3d()->D2(uv[0], uv[1], s, su, sv, suu, svv, suv);
    const gp_Vec r(to_pnt(p), s);
    const double gu = r * su, gv = r * sv, squares = (su * su) * (sv * sv);
    double a = su * su + r * suu, b = su * sv + r * suv, c = sv * sv + r * svv;
    const bool is_convex = a > 0 && a * c - b * b > flat * squares && squares > 0;
    if (!is_convex) {
      const double more = damping * (su * su + sv * sv);
      a = su * su + more;
      b = su * sv;
      c = sv * sv + more;
    }
    const double det = a * c - b * b;
    if (!(det > 0)) return {};
    const double step[2] = {(b * gv - c * gu) / det, (b * gu - a * gv) / det};
    for (int i = 0; i < 2; ++i) {
      uv[i] += step[i];
      const double period = last[i] - first[i];
      const double outside = std::max(first[i] - uv[i], uv[i] - last[i]);
      if (outside > 0 && outside < period && is_closed(i)) uv[i] += uv[i] < first[i] ? period : -period;
      uv[i] = std::min(std::max(uv[i], first[i]), last[i]);
    }
    if (is_convex && std::fabs(step[0]) * su.Magnitude() + std::fabs(step[1]) * sv.Magnitude() < search_tolerance)
      return gp_Pnt2d(uv[0], uv[1]);
  }
  return {};
}

SurfaceFoot::SurfaceFoot(const Surface& surface) : surface_(surface) {
  if (!std::holds_alternative<BSplineSurface>(surface)) return;
  search_ = new ShapeAnalysis_Surface(to_geom(surface));
  double first[2], last[2];
  search_->Bounds(first[0], last[0], first[1], last[1]);
  for (int i = 0; i < first_starts; ++i)
    for (int j = 0; j < first_starts; ++j) {
      const gp_Pnt2d uv(first[0] + (last[0] - first[0]) * (i + 0.5) / first_starts,
                        first[1] + (last[1] - first[1]) * (j + 0.5) / first_starts);
      known_.push_back({to_vec(search_->Value(uv)), uv});
    }
}

Vec3 SurfaceFoot::operator()(Vec3 p, double near_mm) {
  if (search_.IsNull() || !std::isfinite(p.x + p.y + p.z)) return nearest_point(surface_, p);
  // A search that begins at an earlier answer can end on the far side of a body: what is not at hand is searched for
  // from anywhere.
  const auto distance = [&](const gp_Pnt2d& uv) { return norm(to_vec(search_->Value(uv)) - p); };
  const Answer* near = nullptr;
  for (const Answer& known : known_)
    if (!near || norm(known.point - p) < norm(near->point - p)) near = &known;
  if (near && norm(near->point - p) < search_tolerance) return near->point;  // a pole, where no search sets out
  const std::optional<gp_Pnt2d> beside = near ? foot_beside(*search_, near->uv, p) : std::nullopt;
  gp_Pnt2d foot;
  if (beside && distance(*beside) <= near_mm) {
    foot = *beside;
  } else {
    foot = search_->ValueOfUV(to_pnt(p), search_tolerance);
    if (beside && distance(*beside) < distance(foot)) foot = *beside;
    if (known_.size() < most_known) known_.push_back({to_vec(search_->Value(foot)), foot});
  }
  return to_vec(search_->Value(foot));
}

}  // namespace meso::brep
