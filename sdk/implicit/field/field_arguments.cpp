// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/field_arguments.hpp"

#include <cmath>

#include "meso/base/number.hpp"

namespace meso::implicit {

namespace {

bool finite(Vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

std::string text_of(double v) { return std::isnan(v) ? "no number" : std::isinf(v) ? "infinite" : format_number(v); }
std::string text_of(Vec3 v) { return text_of(v.x) + "," + text_of(v.y) + "," + text_of(v.z); }

template <class Value>
Diagnostic fault(std::string_view what, std::string_view needed, Value value) {
  return {.code = Code::implicit_argument, .args = {std::string(what), std::string(needed), text_of(value)}};
}

}  // namespace

std::optional<Diagnostic> check_number(std::string_view what, double value) {
  if (std::isfinite(value)) return std::nullopt;
  return fault(what, "finite", value);
}

std::optional<Diagnostic> check_size(std::string_view what, double value) {
  if (std::isfinite(value) && value > 0) return std::nullopt;
  return fault(what, "finite and larger than 0", value);
}

std::optional<Diagnostic> check_translation(Vec3 displacement) {
  if (finite(displacement)) return std::nullopt;
  return fault("the displacement of a move", "finite", displacement);
}

std::optional<Diagnostic> check_scale(Vec3 factors) {
  // The inverse must be finite too.
  const auto good = [](double f) { return std::isfinite(f) && std::isfinite(1 / f); };
  if (good(factors.x) && good(factors.y) && good(factors.z)) return std::nullopt;
  const bool uniform = factors.x == factors.y && factors.y == factors.z;
  return uniform ? fault("a factor of scale", "finite and not 0", factors.x)
                 : fault("every factor of scale", "finite and not 0", factors);
}

std::optional<Diagnostic> check_rotation(Vec3 axis, double angle) {
  if (auto wrong = check_direction("the axis of a rotation", axis)) return wrong;
  return check_number("the angle of a rotation", angle);
}

std::optional<Diagnostic> check_direction(std::string_view what, Vec3 direction) {
  if (finite(direction) && direction != Vec3{}) return std::nullopt;
  return fault(what, "finite and not 0,0,0", direction);
}

std::optional<Diagnostic> check_shell(double thickness) {
  if (std::isfinite(thickness) && thickness >= 0) return std::nullopt;
  return fault("the thickness of a shell", "finite and not negative", thickness);
}

std::optional<Diagnostic> check_eccentric_shell(double lower, double upper) {
  if (auto wrong = check_number("the lower level of a shell", lower)) return wrong;
  if (std::isfinite(upper) && lower <= upper) return std::nullopt;
  return fault("the upper level of a shell", "finite and not below the lower one, " + text_of(lower), upper);
}

std::optional<Diagnostic> check_cone(double bottom_radius, double top_radius, double height) {
  for (const double radius : {bottom_radius, top_radius})
    if (!std::isfinite(radius) || radius < 0) return fault("a radius of a cone", "finite and not negative", radius);
  if (bottom_radius == 0 && top_radius == 0) return fault("one radius of a cone", "larger than 0", 0.0);
  return check_size("the height of a cone", height);
}

std::optional<Diagnostic> check_torus(double major_radius, double minor_radius) {
  if (auto wrong = check_size("the minor radius of a torus", minor_radius)) return wrong;
  if (std::isfinite(major_radius) && major_radius >= minor_radius) return std::nullopt;
  return fault("the major radius of a torus", "finite and not below the minor one, " + text_of(minor_radius),
               major_radius);
}

}  // namespace meso::implicit
