// SPDX-License-Identifier: Apache-2.0
#include "lattice/curve_fit.hpp"

#include <BSplCLib.hxx>
#include <algorithm>

namespace meso::brep {
namespace {

constexpr int degree = 7;
constexpr std::array<int, 6> counts{8, 10, 14, 22, 38, 70};  ///< points along a curve
constexpr int most_steps = 12;

template <typename Points>
Points poles_through(const Points& points, const TColStd_Array1OfReal& knots, const TColStd_Array1OfReal& at) {
  TColStd_Array1OfInteger order(1, at.Length());
  order.Init(0);
  Points poles = points;
  int problem = 0;
  BSplCLib::Interpolate(degree, knots, at, order, poles, problem);
  if (problem != 0) throw Standard_Failure("a curve cannot be laid through its points");
  return poles;
}

std::optional<FittedCurve> fit(const SharedCurve& on, Vec3 start, Vec3 end, int count, double size) {
  TColgp_Array1OfPnt points(1, count);
  TColgp_Array1OfPnt2d on_a(1, count), on_b(1, count);
  TColStd_Array1OfReal at(1, count);
  const double eps = 0.01 * curve_aim * size;
  for (int i = 0; i < count; ++i) {
    const double t = on.at(i, count);
    Foot a(on.a, on.on_a->Value(t)), b(on.b, on.on_b->Value(t));
    const Vec3 before = to_vec(on.curve->Value(t));
    Vec3 p = i == 0 ? start : end;
    if (i > 0 && i + 1 < count) {
      const auto met = meet(a, b, before, eps);
      if (!met || norm(*met - before) > curve_farthest * size) return {};
      p = *met;
    } else if (!drop(a, p, eps) || !drop(b, p, eps)) {
      return {};
    }
    points(i + 1) = to_pnt(p);
    on_a(i + 1) = a.parameters();
    on_b(i + 1) = b.parameters();
    const double step = i == 0 ? 0 : points(i).Distance(points(i + 1));
    if (i > 0 && step < 10 * eps) return {};
    at(i + 1) = i == 0 ? 0 : at(i) + step;
    if (i > 1 && gp_Vec(points(i - 1), points(i)).Dot(gp_Vec(points(i), points(i + 1))) <= 0) return {};
  }
  // Knots at the points, but for some at each end (de Boor's not-a-knot).
  const int inner = count - degree - 1;
  TColStd_Array1OfReal flat(1, count + degree + 1), knots(1, inner + 2);
  TColStd_Array1OfInteger times(1, inner + 2);
  times.Init(1);
  times(1) = times(inner + 2) = degree + 1;
  knots(1) = at(1);
  knots(inner + 2) = at(count);
  for (int i = 1; i <= inner; ++i) knots(i + 1) = at(i + (degree + 1) / 2);
  for (int i = 1; i <= flat.Length(); ++i) flat(i) = knots(std::clamp(i - degree, 1, inner + 2));
  FittedCurve out{new Geom_BSplineCurve(poles_through(points, flat, at), knots, times, degree),
                  new Geom2d_BSplineCurve(poles_through(on_a, flat, at), knots, times, degree),
                  new Geom2d_BSplineCurve(poles_through(on_b, flat, at), knots, times, degree)};
  for (int i = 1; i < count; ++i)
    for (const double share : {0.25, 0.5, 0.75}) {
      const double t = (1 - share) * at(i) + share * at(i + 1);
      const gp_Pnt p = out.curve->Value(t);
      const gp_Pnt2d a = out.on_a->Value(t), b = out.on_b->Value(t);
      out.off =
          std::fmax(out.off, std::fmax(p.Distance(on.a.Value(a.X(), a.Y())), p.Distance(on.b.Value(b.X(), b.Y()))));
    }
  return out;
}

}  // namespace

void Foot::look() {
  gp_Pnt p;
  gp_Vec du, dv;
  surface_.D1(u_, v_, p, du, dv);
  point_ = to_vec(p);
  du_ = to_vec(du.XYZ());
  dv_ = to_vec(dv.XYZ());
  const Vec3 across = cross(du_, dv_);
  const double area = norm(across);
  regular_ = area > 1e-6 * norm(du_) * norm(dv_) && area > 0;
  normal_ = regular_ ? across / area : Vec3{};
}

void Foot::follow(Vec3 p) {
  const Vec3 to = p - point_;
  const double a = dot(du_, du_), b = dot(du_, dv_), c = dot(dv_, dv_), det = a * c - b * b;
  const double along_u = dot(du_, to), along_v = dot(dv_, to);
  u_ += (c * along_u - b * along_v) / det;
  v_ += (a * along_v - b * along_u) / det;
  look();
}

bool drop(Foot& foot, Vec3 p, double eps) {
  for (int step = 0; step < most_steps && foot.regular(); ++step) {
    const Vec3 before = foot.point();
    foot.follow(p);
    if (foot.regular() && norm(foot.point() - before) < eps) return true;
  }
  return false;
}

std::optional<Vec3> meet(Foot& a, Foot& b, Vec3 p, double eps) {
  for (int step = 0; step < most_steps && a.regular() && b.regular(); ++step) {
    const double c = dot(a.normal(), b.normal()), det = 1 - c * c;
    if (det < curve_flattest * curve_flattest) return {};
    const double to_a = dot(a.normal(), a.point() - p), to_b = dot(b.normal(), b.point() - p);
    p += (to_a - c * to_b) / det * a.normal() + (to_b - c * to_a) / det * b.normal();
    a.follow(p);
    b.follow(p);
    if (a.regular() && b.regular() && norm(a.point() - p) < eps && norm(b.point() - p) < eps) return p;
  }
  return {};
}

std::optional<FittedCurve> fit_curve(const SharedCurve& on, Vec3 start, Vec3 end, double size) {
  std::optional<FittedCurve> best;
  for (const int count : counts) {
    try {
      auto fitted = fit(on, start, end, count, size);
      if (!fitted) continue;  // too few points to follow a sharp turn
      if (!best || fitted->off < best->off) best = std::move(fitted);
    } catch (const Standard_Failure&) {
    }
    if (best && best->off <= curve_aim * size) break;
  }
  return best;
}

}  // namespace meso::brep
