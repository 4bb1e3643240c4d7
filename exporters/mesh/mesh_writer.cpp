// SPDX-License-Identifier: Apache-2.0
#include "meso/export_mesh/mesh_writer.hpp"

#include "ply_writer.hpp"

namespace meso {

std::unique_ptr<MeshSink> make_mesh_writer(MeshFormat format, OutputFile& file) {
  switch (format) {
    case MeshFormat::ply:
      return std::make_unique<PlyWriter<float>>(file);
    case MeshFormat::ply_double:
      return std::make_unique<PlyWriter<double>>(file);
  }
  return nullptr;
}

}  // namespace meso
