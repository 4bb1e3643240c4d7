// SPDX-License-Identifier: Apache-2.0
#pragma once
// How a pattern of one cell says cylindrical, spherical and helix, read both ways. Private.
//
// The cell's body is the solid as a part, its box all of the solid that the bounds show, and mapping="conformal" takes
// the box's sides to a distance, a full turn, and a height or half a turn from pole to pole. A helix is the solid
// sheared along z as far as a turn rises, and bent as by cylindrical.

#include <functional>
#include <optional>
#include <string>

#include "meso/model/document.hpp"
#include "meso/sdf/program.hpp"

namespace meso::sdf {

/// Units of y in a turn about z and, of spherical, of z from pole to pole; negative ones go round the other way.
struct Bend {
  bool is_spherical = false;
  double turn = 0, poles = 0;
  Box3 solid{};  ///< what is bent
};

/// Of cylindrical, spherical or helix: all of the (sheared) solid that comes into the region.
[[nodiscard]] Bend bend_of(const Instruction& word, const Box3& region);
/// A box around all that the shear of a helix brings into `sheared`.
[[nodiscard]] Box3 before_shear(const Box3& sheared, double rise);

/// Into the system, the cell's box and the pattern; the parameters prefix + "Turn" and prefix + "Poles" hold the sizes.
void write_bend(const Bend& bend, const std::string& prefix, CoordinateSystem& system, CellBox& box, Pattern& pattern);
/// Nothing if it bends otherwise.
[[nodiscard]] std::optional<Bend> read_bend(const CoordinateSystem& system, const CellBox& box, const Pattern& pattern,
                                            const std::function<double(const Expression&)>& value);
/// Whether words, which cut nothing, say the same in the region.
[[nodiscard]] bool shows_all(const Bend& bend, const Box3& region);

/// z + y Rise/Turn, of parameters whose names begin so.
[[nodiscard]] std::string shear_matrix(const std::string& prefix);

}  // namespace meso::sdf
