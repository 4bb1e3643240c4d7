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

/// `.meso`: recomputes the validation values of the parts that are made; `.step .stp .stl`: audits the file.
[[nodiscard]] std::optional<VerifyReport> verify(const std::filesystem::path& file, const MakeOptions& options,
                                                 DiagnosticSink& sink);

}  // namespace meso::operations
