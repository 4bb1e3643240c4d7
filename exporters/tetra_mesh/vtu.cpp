// SPDX-License-Identifier: Apache-2.0
// VTK's unstructured grid. Appended raw data starts after an underscore; each array is led by its size in bytes.

#include <string>

#include "formats.hpp"

namespace meso {
namespace {

constexpr std::uint8_t vtk_tetra = 10;

std::string opening(const TetMesh& mesh) {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
         "header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"" +
         std::to_string(mesh.points.size()) + "\" NumberOfCells=\"" + std::to_string(mesh.tets.size()) + "\">\n";
}

/// Arrays in the order of their data.
class AppendedArrays {
 public:
  std::string next(const std::string& attributes, std::uint64_t bytes) {
    const std::string element =
        "<DataArray " + attributes + " format=\"appended\" offset=\"" + std::to_string(offset_) + "\"/>\n";
    offset_ += sizeof bytes + bytes;
    return element;
  }

 private:
  std::uint64_t offset_ = 0;
};

}  // namespace

void write_vtu(const TetMesh& mesh, Chunked& out) {
  const std::uint64_t points = mesh.points.size(), tets = mesh.tets.size();
  const std::uint64_t point_bytes = points * 3 * sizeof(double), corner_bytes = tets * 4 * sizeof(std::uint32_t),
                      offset_bytes = tets * sizeof(std::uint64_t);
  AppendedArrays arrays;
  out.text(opening(mesh) + "<Points>\n");
  out.text(arrays.next("type=\"Float64\" Name=\"points\" NumberOfComponents=\"3\"", point_bytes));
  out.text("</Points>\n<Cells>\n");
  out.text(arrays.next("type=\"UInt32\" Name=\"connectivity\"", corner_bytes));
  out.text(arrays.next("type=\"UInt64\" Name=\"offsets\"", offset_bytes));
  out.text(arrays.next("type=\"UInt8\" Name=\"types\"", tets));
  out.text("</Cells>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_");
  out.raw(point_bytes);
  for (const Vec3& p : mesh.points) out.raw(p);
  out.raw(corner_bytes);
  for (const auto& t : mesh.tets) out.raw(t);
  out.raw(offset_bytes);
  for (std::uint64_t i = 1; i <= tets; ++i) out.raw(4 * i);
  out.raw(tets);
  for (std::uint64_t i = 0; i < tets; ++i) out.raw(vtk_tetra);
  out.text("\n</AppendedData>\n</VTKFile>\n");
}

void write_vtu_ascii(const TetMesh& mesh, Chunked& out) {
  out.text(opening(mesh) +
           "<Points>\n<DataArray type=\"Float64\" Name=\"points\" NumberOfComponents=\"3\" format=\"ascii\">\n");
  for (const Vec3& p : mesh.points)
    for (std::size_t a = 0; a < 3; ++a) {
      out.number(p[a]);
      out.text(a < 2 ? " " : "\n");
    }
  out.text("</DataArray>\n</Points>\n<Cells>\n<DataArray type=\"UInt32\" Name=\"connectivity\" format=\"ascii\">\n");
  for (const auto& t : mesh.tets)
    for (std::size_t c = 0; c < 4; ++c) {
      out.number(t[c]);
      out.text(c < 3 ? " " : "\n");
    }
  out.text("</DataArray>\n<DataArray type=\"UInt64\" Name=\"offsets\" format=\"ascii\">\n");
  for (std::uint64_t i = 1; i <= mesh.tets.size(); ++i) {
    out.number(4 * i);
    out.text("\n");
  }
  out.text("</DataArray>\n<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">\n");
  for (std::size_t i = 0; i < mesh.tets.size(); ++i) out.text("10\n");
  out.text("</DataArray>\n</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
}

}  // namespace meso
