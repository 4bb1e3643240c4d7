// SPDX-License-Identifier: Apache-2.0
#pragma once
// Is an argument good for an operation of Field? The answer is the diagnostic (IMPLICIT_ARGUMENT) or nothing; who asks
// adds the place. A field's functions assert what is checked here.
//
//   if (auto fault = check_scale({1, 0, 2})) sink.report(*fault);   // "a factor of scale must not be 0, it is 0"

#include <optional>
#include <string_view>

#include "meso/base/diagnostic.hpp"
#include "meso/base/vec.hpp"

namespace meso::implicit {

/// Any finite number: an offset, an angle, an isovalue, a component of a displacement. `what` names it in the message.
[[nodiscard]] std::optional<Diagnostic> check_number(std::string_view what, double value);
/// A size of a primitive: finite and > 0.
[[nodiscard]] std::optional<Diagnostic> check_size(std::string_view what, double value);
[[nodiscard]] std::optional<Diagnostic> check_translation(Vec3 displacement);
[[nodiscard]] std::optional<Diagnostic> check_scale(Vec3 factors);
[[nodiscard]] std::optional<Diagnostic> check_rotation(Vec3 axis, double angle);
/// Of orient, mirror and half-space: finite and not 0.
[[nodiscard]] std::optional<Diagnostic> check_direction(std::string_view what, Vec3 direction);
[[nodiscard]] std::optional<Diagnostic> check_shell(double thickness);
[[nodiscard]] std::optional<Diagnostic> check_eccentric_shell(double lower, double upper);
[[nodiscard]] std::optional<Diagnostic> check_cone(double bottom_radius, double top_radius, double height);
[[nodiscard]] std::optional<Diagnostic> check_torus(double major_radius, double minor_radius);

}  // namespace meso::implicit
