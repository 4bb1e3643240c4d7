// SPDX-License-Identifier: Apache-2.0
#pragma once
// The plane faces in which a jointed box ends: within the arcs of its balls and the lines of struts in its sides, and
// along the edges of the box. Private.

#include <string>
#include <vector>

#include "lattice/ball_sectors.hpp"

namespace meso::brep {

/// `lines`: in each side, as the struts use them. False, and why, where the edges of a side do not close.
[[nodiscard]] bool add_walls(const JointedBox& box, const BallSectors& sectors,
                             const std::array<std::vector<Coedge>, 6>& lines, CellEdges& edges,
                             std::vector<FaceTemplate>& faces, std::string& why);

}  // namespace meso::brep
