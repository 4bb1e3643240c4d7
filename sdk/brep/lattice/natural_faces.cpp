// SPDX-License-Identifier: Apache-2.0
#include "lattice/natural_faces.hpp"

namespace meso::brep {

void find_natural_faces(Quotient& quotient) { quotient.part_of.resize(quotient.kinds[0].faces.size()); }

}  // namespace meso::brep
