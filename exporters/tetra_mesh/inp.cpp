// SPDX-License-Identifier: Apache-2.0
// Abaqus and CalculiX. Sets take at most 16 numbers a line, and a number at most 20 characters: CalculiX leaves out the
// rest, an exponent too.

#include <string>

#include "formats.hpp"
#include "sides.hpp"

namespace meso {
namespace {

constexpr int coordinate_digits = 13;  // -1.234567890123e-100

std::string upper(std::string_view name) {
  std::string out(name);
  for (char& c : out)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return out;
}

template <class Numbers>
void write_set(const std::string& heading, const Numbers& numbers, Chunked& out) {
  out.text(heading);
  std::size_t i = 0;
  for (const std::uint32_t n : numbers) {
    out.text(i++ % 16 == 0 ? "\n" : ",");
    out.number(std::uint64_t{n} + 1);
  }
  out.text("\n");
}

void write_side(const TetMesh& mesh, TetMesh::Side side, Chunked& out) {
  const auto faces = faces_of(mesh, side);
  if (faces.empty()) return;
  const std::string name = upper(TetMesh::side_names[static_cast<std::size_t>(side)]);
  write_set("*NSET, NSET=" + name, points_of(mesh, faces), out);
  std::vector<std::uint32_t> elements;  // a tetrahedron may have two faces on one side
  for (const TetMesh::Face& f : faces)
    if (elements.empty() || elements.back() != f.tet) elements.push_back(f.tet);
  write_set("*ELSET, ELSET=" + name, elements, out);
  out.text("*SURFACE, NAME=S_" + name + ", TYPE=ELEMENT\n");
  for (const TetMesh::Face& f : faces) {
    out.number(std::uint64_t{f.tet} + 1);
    out.text(", S");
    out.number(f.face + 1);
    out.text("\n");
  }
}

}  // namespace

void write_inp(const TetMesh& mesh, Chunked& out) {
  out.text("** tetrahedra in millimetres, written by meso\n*NODE, NSET=ALL\n");
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    out.number(i + 1);
    for (std::size_t a = 0; a < 3; ++a) {
      out.text(",");
      out.number(mesh.points[i][a], coordinate_digits);
    }
    out.text("\n");
  }
  out.text("*ELEMENT, TYPE=C3D4, ELSET=SOLID\n");
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    out.number(t + 1);
    for (const std::uint32_t c : mesh.tets[t]) {
      out.text(",");
      out.number(std::uint64_t{c} + 1);
    }
    out.text("\n");
  }
  for (std::size_t s = 0; s < TetMesh::side_count; ++s) write_side(mesh, static_cast<TetMesh::Side>(s), out);
}

}  // namespace meso
