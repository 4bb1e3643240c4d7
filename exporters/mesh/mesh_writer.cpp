// SPDX-License-Identifier: Apache-2.0
#include "meso/export_mesh/mesh_writer.hpp"

#include <cassert>
#include <utility>

#include "ply_writer.hpp"
#include "stl_writer.hpp"
#include "text_writers.hpp"
#ifdef MESO_WITH_ZIP
#include "threemf_writer.hpp"
#endif
#include "vtk_writer.hpp"

namespace meso {

std::string_view mesh_extensions() {
#ifdef MESO_WITH_ZIP
  return ".stl .3mf .ply .obj .off .vtk";
#else
  return ".stl .ply .obj .off .vtk";
#endif
}

std::optional<MeshFormat> mesh_format_of(std::string_view path) {
  static constexpr std::pair<std::string_view, MeshFormat> endings[] = {
      {".ply", MeshFormat::ply},     {".stl", MeshFormat::stl}, {".obj", MeshFormat::obj},
      {".off", MeshFormat::off},     {".vtk", MeshFormat::vtk},
#ifdef MESO_WITH_ZIP
      {".3mf", MeshFormat::threemf},
#endif
  };
  if (path.size() < 4) return std::nullopt;
  std::string ending(path.substr(path.size() - 4));
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  for (const auto& [text, format] : endings)
    if (ending == text) return format;
  return std::nullopt;
}

namespace {

template <class Real>
std::unique_ptr<MeshSink> make_writer(MeshFormat format, OutputFile& file) {
  switch (format) {
    case MeshFormat::ply:
      return std::make_unique<PlyWriter<Real>>(file);
    case MeshFormat::stl:
      return std::make_unique<StlWriter>(file, StlFormat::binary);
    case MeshFormat::stl_ascii:
      return std::make_unique<StlWriter>(file, StlFormat::ascii);
    case MeshFormat::obj:
      return std::make_unique<ObjWriter<Real>>(file);
    case MeshFormat::off:
      return std::make_unique<OffWriter<Real>>(file);
    case MeshFormat::vtk:
      return std::make_unique<VtkWriter<Real>>(file);
    case MeshFormat::threemf:
#ifdef MESO_WITH_ZIP
      return std::make_unique<ThreeMfWriter<Real>>(file);
#else
      break;
#endif
  }
  return nullptr;
}

}  // namespace

std::unique_ptr<MeshSink> make_mesh_writer(MeshFormat format, OutputFile& file, Coordinates coordinates) {
  assert(coordinates == Coordinates::as_float || can_hold_doubles(format));
  return coordinates == Coordinates::as_double ? make_writer<double>(format, file) : make_writer<float>(format, file);
}

}  // namespace meso
