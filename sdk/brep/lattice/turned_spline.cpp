// SPDX-License-Identifier: Apache-2.0
#include "lattice/turned_spline.hpp"

#include <cmath>

namespace meso::brep {
namespace {

constexpr double same = 1e-7;  ///< millimetres by which a surface may change where it closes

/// Its first parameter. False where it does not close smoothly.
bool turn_first(Geom_BSplineSurface& surface, double at) {
  if (!surface.IsUPeriodic()) surface.SetUPeriodic();
  double first = 0, last = 0, low = 0, high = 0;
  surface.Bounds(first, last, low, high);
  const double period = last - first, least = 1e-9 * period;
  const double far = first + std::remainder(at - first, period) + 0.5 * period;
  if (far - first < least || last - far < least) {
    surface.SetUNotPeriodic();
    return true;
  }
  surface.InsertUKnot(far, 1, least, Standard_False);
  int at_far = 0, next = 0;
  surface.LocateU(far, least, at_far, next);
  surface.SetUOrigin(at_far);
  surface.SetUNotPeriodic();
  int seam = 0;
  surface.LocateU(first < far ? last : first, least, seam, next);
  if (surface.UMultiplicity(seam) < surface.UDegree()) return true;
  for (int multiplicity = 1; multiplicity < surface.UDegree(); ++multiplicity)
    if (surface.RemoveUKnot(seam, multiplicity, same)) return true;
  return false;
}

}  // namespace

Handle(Geom_BSplineSurface) turned_to(const Handle(Geom_BSplineSurface) & surface, const std::array<double, 2>& at) {
  const std::array<bool, 2> closes{surface->IsUClosed() == Standard_True, surface->IsVClosed() == Standard_True};
  if (!closes[0] && !closes[1]) return {};
  const Handle(Geom_BSplineSurface) out = Handle(Geom_BSplineSurface)::DownCast(surface->Copy());
  if (closes[0] && !turn_first(*out, at[0])) return {};
  if (!closes[1]) return out;
  out->ExchangeUV();
  const bool is_smooth = turn_first(*out, at[1]);
  out->ExchangeUV();
  return is_smooth ? out : Handle(Geom_BSplineSurface)();
}

}  // namespace meso::brep
