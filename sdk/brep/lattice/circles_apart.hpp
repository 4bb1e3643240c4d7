// SPDX-License-Identifier: Apache-2.0
#pragma once
// Cells in which the circles of struts do not touch. Private.
//
// An automatic ball is as small as it can be: the circles in which two of its struts end touch, and what is left of the
// ball beside that point is two tips. A body whose surface passes within some hundredths of a strut's radius of it cuts
// faces into pieces of a millionth of that, which OpenCASCADE does not find. With a little more of a ball between the
// circles there are no tips, and all such bodies were cut that had failed.

#include "lattice/cell_solid.hpp"

namespace meso::brep {

/// The cell with balls larger by a ten-thousandth; those that only round off a strut remain. Nothing where there is no
/// other ball. O(n log n) in primitives.
[[nodiscard]] std::optional<CellShape> with_circles_apart(const CellShape& cell);

}  // namespace meso::brep
