// SPDX-License-Identifier: Apache-2.0
#pragma once
// Length units of documents and of unit suffixes.

namespace meso {

enum class LengthUnit { micrometer, millimeter, centimeter, meter, inch, foot };

[[nodiscard]] constexpr double millimeters_per(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::micrometer:
      return 1e-3;
    case LengthUnit::millimeter:
      return 1;
    case LengthUnit::centimeter:
      return 10;
    case LengthUnit::meter:
      return 1e3;
    case LengthUnit::inch:
      return 25.4;
    case LengthUnit::foot:
      return 304.8;
  }
  return 1;
}

}  // namespace meso
