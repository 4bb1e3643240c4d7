// SPDX-License-Identifier: Apache-2.0
#pragma once
// Regroups sums and products so that as much as possible is computed per axis or per plane instead of per sample: every
// function of x and other axes that is a polynomial in rows A(x) becomes s0(y, z) + A1(x) s1(y, z) + A2(x) s2(y, z)
// ..., one multiplication and one addition per row and sample. All 27 named surfaces need at most six.
//
//   cos x sin y + cos y sin z + cos z sin x   ->   cos y sin z + cos x * sin y + sin x * cos z
//   sin(x - y)                                ->   0 + sin x * cos y + cos x * -sin y
//   max(gyroid, sqrt(x^2 + y^2 + z^2) - 1)    ->   max(sum, sum of sqrt(sum of squares))

#include "graph.hpp"
#include "meso/implicit/grid.hpp"

namespace meso::implicit {

/// The node that gives the values of `root` in the grid's box, except for rounding: what is regrouped may add 1e-12 of
/// the range of values that it has there, by a first-order bound (Higham, "Accuracy and Stability", section 3.1) with
/// magnitudes and ranges taken from samples. Where that bound is exceeded or a sample is not finite nothing is
/// regrouped.
[[nodiscard]] Graph::Id separate(Graph& graph, Graph::Id root, const Grid& grid);

}  // namespace meso::implicit
