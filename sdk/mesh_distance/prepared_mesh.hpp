// SPDX-License-Identifier: Apache-2.0
#pragma once
// A mesh on one grid: signs of all nodes, and which blocks of nodes come near enough to the surface for distances.

#include "meso/implicit/external_field.hpp"
#include "signed_mesh.hpp"

namespace meso::implicit {

/// Empty if the run was stopped.
[[nodiscard]] std::unique_ptr<ExternalField::Prepared> prepare_mesh(std::shared_ptr<const SignedMesh> mesh,
                                                                    const Grid& grid, const Affine& field_from_grid,
                                                                    double band, const RunOptions& options);

}  // namespace meso::implicit
