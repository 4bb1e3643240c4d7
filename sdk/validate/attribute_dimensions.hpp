// SPDX-License-Identifier: Apache-2.0
#pragma once
// which attributes are lengths, angles and numbers. Everything else is open: what is counted along an axis
// values of parameters, functions and levels, directions.

#include <algorithm>
#include <array>
#include <concepts>
#include <string_view>

#include "meso/expr/dimension.hpp"
#include "meso/model/document.hpp"

namespace meso {

template <class T, class... Ts>
concept AnyOf = (std::same_as<T, Ts> || ...);

/// Elements whose x y z are a direction.
template <class E>
concept Directed = AnyOf<E, Axis, CsgRotate, Loop, OrientInstruction, SecondDirection, RotateInstruction>;
/// Elements whose x y z are factors.
template <class E>
concept Scaled = AnyOf<E, CsgScale, ScaleInstruction>;

template <class E>
[[nodiscard]] expr::Dimension attribute_dimension(std::string_view name) {
  static constexpr auto coordinates = std::to_array<std::string_view>({"x", "y", "z"});
  static constexpr auto lengths = std::to_array<std::string_view>(
      {"x",           "y",           "z",      "x1",   "y1",        "z1",      "x2",       "y2",
       "z2",          "dx",          "dy",     "dz",   "topX",      "topY",    "topDx",    "topDy",
       "r",           "rx",          "ry",     "rz",   "radius",    "radius1", "radius2",  "nodeRadius",
       "majorRadius", "minorRadius", "height", "wall", "clearance", "skin",    "distance", "deflection"});
  static constexpr auto numbers =
      std::to_array<std::string_view>({"count", "density", "factor", "power", "samples", "vertices", "weight"});
  const auto has = [&](const auto& names) { return std::ranges::find(names, name) != names.end(); };
  if (has(coordinates) && Directed<E>) return expr::Dimension::open;
  if (has(numbers) || (has(coordinates) && Scaled<E>)) return expr::Dimension::number;
  if (has(lengths)) return expr::Dimension::length;
  return name == "angle" ? expr::Dimension::angle : expr::Dimension::open;
}

}  // namespace meso
