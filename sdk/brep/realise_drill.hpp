// SPDX-License-Identifier: Apache-2.0
#pragma once
// Holes through plane faces, put in without a boolean. Private.
//
//   Drill drill(body);
//   if (!drill.add(cells, cell)) joined.push_back(...);   // left to a boolean
//   Solids out = drill.drilled();
//
// A cutter that is a straight prism (walls plane or cylindrical and parallel to its axis, one outline), perpendicular
// to every face of the body that it meets, all of these plane, and its outline strictly within those faces: what it
// takes out are prisms between faces, or between a face and its own end. Each adds its outline to the faces at its
// ends, its walls, and a bottom where it is blind; nothing else of the body changes, and the body stays as connected as
// it was. Cutters must keep clear of each other. Cost: about 0.2 ms a hole; OpenCASCADE's cut takes ten to thirty, and
// more the more holes there are.

#include <map>
#include <memory>

#include "realise_cells.hpp"

namespace meso::brep {

class Drill {
 public:
  explicit Drill(const Solids& body);
  ~Drill();
  Drill(const Drill&) = delete;
  Drill& operator=(const Drill&) = delete;

  /// True, and the holes are noted, if the cell can be put in and takes something away. May throw Standard_Failure.
  [[nodiscard]] bool add(const CellSolids& cells, const CellSolid& cell);
  /// The body with all holes noted. May throw Standard_Failure.
  [[nodiscard]] Solids drilled() const;

 private:
  struct BodyFace;
  struct Bore;
  struct Crossing;
  struct Hole;

  void list_faces();
  [[nodiscard]] static std::vector<Bore> bores_of(const Prototype& prototype);
  [[nodiscard]] std::vector<Hole> holes_of(const Bore& bore, const CellSolids& cells, const CellSolid& cell);
  [[nodiscard]] std::optional<std::vector<Crossing>> crossings(const Bore& bore, const CellSolids& cells,
                                                               const CellSolid& cell);
  [[nodiscard]] std::optional<std::vector<Hole>> holes_between(const std::vector<Crossing>& crossings,
                                                               const Bore& bore) const;

  Solids body_;
  std::vector<BodyFace> faces_;  ///< once a prism has come
  std::vector<Hole> holes_;
  std::map<std::size_t, std::vector<Bore>> bores_;  ///< by prototype: a box is a prism in three directions
};

}  // namespace meso::brep
