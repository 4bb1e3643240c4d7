// SPDX-License-Identifier: Apache-2.0
#pragma once
// Does a document's part have the stated volume, counts and points? Is a STEP or STL file a closed, oriented solid?

#include "meso/operations/convert.hpp"

namespace meso::operations {

struct Check {
  std::string what;      ///< "volume", "centroid.x", "sample 3", "closed" ...
  std::string expected;  ///< as text
  std::string found;
  bool passed = false;
};
struct VerifyReport {
  std::vector<Check> checks;
  brep::Measures measures;
  bool closed = false;
  std::uint64_t triangles = 0;  ///< STL only
  [[nodiscard]] bool passed() const;
};

/// How closely a part is looked at besides its stated values: edge uses, face integrals, and random points that are
/// judged from the document's definitions alone (sdk/membership), against the volume and against the body's triangles.
struct DeepCheck {
  std::size_t points = 2'000'000;
  std::uint64_t seed = 1;
};

/// `.meso`: recomputes the validation values of the parts that are made; `.step .stp .stl`: audits the file. With
/// `deep`, which needs a document, every part that is made is looked at, whether it states values or not.
[[nodiscard]] std::optional<VerifyReport> verify(const std::filesystem::path& file, const MakeOptions& options,
                                                 const std::optional<DeepCheck>& deep, DiagnosticSink& sink);

}  // namespace meso::operations
