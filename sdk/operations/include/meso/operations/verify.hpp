// SPDX-License-Identifier: Apache-2.0
#pragma once
// Does a document's part have the stated volume, counts and points? Is a STEP or STL file a closed, oriented solid?

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "meso/operations/convert.hpp"

namespace meso::operations {

struct Check {
  std::string what;      ///< "volume", "centroid.x", "sample 3", "closed" ...
  std::string expected;  ///< as text
  std::string found;
  bool passed = false;
};
/// What a deep check has measured of one part. Millimetres.
struct DeepFigures {
  std::string part;
  double shells_volume = 0;  ///< by the exact integrals over the faces
  double pieces_volume = 0;  ///< of what the part was put together from, each integrated before that; 0: not known
  // Monte Carlo: random points, judged from the document's definitions.
  std::uint64_t points = 0, seed = 0;
  double points_volume = 0, points_volume_high = 0;  ///< without and with what cannot be judged
  double sigma = 0;                                  ///< one standard deviation of these
  double difference = 0;                             ///< of the exact volume from them; 0 between them
  double triangles_volume = 0;                       ///< of the triangles
  double triangles_gap_volume = 0;                   ///< between the triangles and the exact faces
  double triangle_gap = 0, deflection = 0;  ///< largest distance of a triangle from its face; what was asked for
  double edge_gap = 0, vertex_gap = 0;      ///< largest distances: edges from faces, vertices from edges
  std::uint64_t solids = 0, fragments = 0;
  std::uint64_t unmatched_half_edges = 0;  ///< of the triangles as STL has them
  std::vector<double> shell_volumes;       ///< voids are negative
  std::vector<double> read_back_volumes;  ///< the same of the STEP file, read by OpenCASCADE; empty: too large for that
};

struct VerifyReport {
  std::vector<Check> checks;
  std::vector<std::string> notes;     ///< what was not looked at, and why
  std::vector<DeepFigures> deep;      ///< one for each part
  std::vector<double> shell_volumes;  ///< of a STEP file, voids negative, in the order of their size; mm3
  brep::Measures measures;
  bool measured = true;  ///< false: volume, area and the like of `measures` are not known, its counts are
  bool closed = false;
  std::uint64_t triangles = 0;  ///< STL only
  [[nodiscard]] bool passed() const;
};

/// How closely a part is looked at besides its stated values: edge uses, face integrals, distances of edges from faces,
/// the triangles as STL has them, the STEP file read back, and random points that are judged from the document's
/// definitions alone (sdk/membership), against the volume and against the body's triangles.
struct DeepCheck {
  std::optional<std::size_t> points{};  ///< absent: so many that their deviation is a thousandth of the volume
  std::uint64_t seed = 1;
  /// OpenCASCADE's reader takes 5 s for these, and grows with the square; a free-form face counts as twenty.
  std::uint64_t most_faces_read_back = 5000;
};

/// `.meso`: recomputes the validation values of the parts that are made; `.step .stp .stl`: audits the file. With
/// `deep`, every part that is made is looked at, whether it states values or not, and a STEP file of any size is read
/// by OpenCASCADE, which takes 5 s for 5 000 faces and four times as long for twice as many.
[[nodiscard]] std::optional<VerifyReport> verify(const std::filesystem::path& file, const MakeOptions& options,
                                                 const std::optional<DeepCheck>& deep, DiagnosticSink& sink);

}  // namespace meso::operations
