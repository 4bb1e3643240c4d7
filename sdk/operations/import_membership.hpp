// SPDX-License-Identifier: Apache-2.0
#pragma once
// Imported bodies for the independent judge: as triangles. Private.

#include <filesystem>
#include <map>

#include "meso/base/diagnostic.hpp"
#include "meso/base/triangle_mesh.hpp"
#include "meso/membership/membership.hpp"

namespace meso::operations {

class ImportedBodies {
 public:
  ImportedBodies(const RunOptions& run, DiagnosticSink& sink) : run_(run), sink_(sink) {}

  /// Reads each file once. Nothing, reported, for files that no reader reads.
  [[nodiscard]] std::optional<membership::ImportedSolid> read(const eval::ImportShape& import);

  /// What the triangles may miss where faces are curved: as a distance, and as a volume.
  [[nodiscard]] double error_mm() const { return error_mm_; }
  [[nodiscard]] double error_mm3() const { return error_mm3_; }

 private:
  [[nodiscard]] std::optional<TriangleMesh> triangles(const eval::ImportShape& import);

  const RunOptions& run_;
  DiagnosticSink& sink_;
  std::map<std::filesystem::path, std::optional<membership::ImportedSolid>> known_;
  double error_mm_ = 0, error_mm3_ = 0;
};

}  // namespace meso::operations
