// SPDX-License-Identifier: Apache-2.0
#pragma once
// One function for each format. Private.

#include "chunked.hpp"
#include "meso/base/tet_mesh.hpp"

namespace meso {

void write_vtu(const TetMesh& mesh, Chunked& out);
void write_vtu_ascii(const TetMesh& mesh, Chunked& out);
void write_msh(const TetMesh& mesh, Chunked& out);
void write_inp(const TetMesh& mesh, Chunked& out);

}  // namespace meso
