// SPDX-License-Identifier: Apache-2.0
#pragma once
// loops, scatter, list and fill.

#include "families.hpp"

namespace meso {

/// Checks the pattern's generator and adds its indices and field components to the pattern's `names`. `axes` is null
/// if the link to the coordinate system is broken.
void check_generator(Context& c, const Pattern& pattern, const std::vector<Axis>* axes, Scope& names);

/// A step along each of the first three axes.
void check_conformal_generator(Context& c, const Pattern& pattern, const std::vector<Axis>& axes);

}  // namespace meso
