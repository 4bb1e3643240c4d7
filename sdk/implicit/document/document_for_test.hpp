// SPDX-License-Identifier: Apache-2.0
#pragma once
// Documents of tests: text or file in, evaluation and field out. Part of tests.

#include <gtest/gtest.h>

#include <filesystem>
#include <random>
#include <string>

#include "meso/implicit/document_field.hpp"
#include "meso/validate/validate.hpp"
#include "meso/xml/read.hpp"

namespace meso::implicit {

inline std::string told(const DiagnosticSink& sink) {
  std::string text;
  for (const Diagnostic& d : sink.diagnostics()) text += render(d) + "\n";
  return text;
}

/// A document and the field of one of its parts.
struct TestDocument {
  explicit TestDocument(const std::string& content, const std::string& part = "p",
                        const ImportMeshReader& imports = {}) {
    auto read =
        read_document("<meso xmlns=\"urn:meso-format:1.0\" version=\"1.0\" unit=\"millimeter\">" + content + "</meso>",
                      "test.meso", sink);
    open(std::move(read), ".");
    if (evaluation) make(part, imports);
  }
  explicit TestDocument(const std::filesystem::path& file) {
    auto read = read_document_file(file, sink);
    open(std::move(read), file.parent_path());
  }
  template <class Read>
  void open(Read read, const std::filesystem::path& folder) {
    const auto checked =
        read ? validate(std::move(read->document), std::move(read->source), folder, sink) : std::nullopt;
    if (checked) evaluation = eval::Evaluation::make(*checked, {}, sink);
    EXPECT_TRUE(evaluation) << told(sink);
  }
  void make(const std::string& part, const ImportMeshReader& imports = {}) {
    made = field_of_part(*evaluation, *evaluation->find_part(part), {.imports = imports}, sink);
  }
  [[nodiscard]] const Field& field() const {
    if (!made) throw std::logic_error(told(sink));
    return made->field;
  }
  [[nodiscard]] Code code() const { return sink.diagnostics().empty() ? Code::internal : sink.diagnostics()[0].code; }

  DiagnosticSink sink;
  std::optional<eval::Evaluation> evaluation;
  std::optional<PartField> made;
};

inline std::string macrostructure(const std::string& csg) {
  return "<macrostructures><macrostructure id='m'><csg>" + csg + "</csg></macrostructure></macrostructures>";
}
inline std::string part_of(const std::string& steps, bool with_body = true) {
  return std::string("<parts><part id='p'") + (with_body ? " macrostructure='m'" : "") + ">" + steps +
         "</part></parts>";
}
/// The pattern "c" of the unit cell "u".
inline std::string cells(const std::string& cell, const std::string& generator, const std::string& attributes = "") {
  return "<unitCells><unitCell id='u'>" + cell + "</unitCell></unitCells><patterns><pattern id='c' unitCell='u' " +
         attributes + ">" + generator + "</pattern></patterns>";
}
inline std::string loops(int nx, int ny, int nz, double pitch) {
  std::string text;
  const int counts[] = {nx, ny, nz};
  for (int a = 0; a < 3; ++a)
    text += std::string("<loop index='") + "ijk"[a] + "' axis='" + "xyz"[a] + "' count='" + std::to_string(counts[a]) +
            "' spacing='" + std::to_string(pitch) + "'/>";
  return text;
}

/// Points of a box, the same in every run.
class RandomPoints {
 public:
  explicit RandomPoints(const Box3& box, unsigned seed = 1) : box_(box), random_(seed) {}
  Vec3 operator()() {
    Vec3 p;
    for (std::size_t a = 0; a < 3; ++a)
      p[a] = box_.min[a] + static_cast<double>(random_() >> 11) * 0x1p-53 * (box_.max[a] - box_.min[a]);
    return p;
  }

 private:
  Box3 box_;
  std::mt19937_64 random_;
};

/// Volume by a lattice of points that lies on no plane of the bodies.
inline double volume_by_points(const Field& field, int along = 60) {
  const Box3 box = field.bounds();
  const Vec3 step = (box.max - box.min) / along;
  int inside = 0;
  std::vector<Vec3> points(static_cast<std::size_t>(along));
  std::vector<double> values(points.size());
  for (int j = 0; j < along; ++j)
    for (int k = 0; k < along; ++k) {
      for (int i = 0; i < along; ++i)
        points[static_cast<std::size_t>(i)] =
            box.min + Vec3{(i + 0.4919) * step.x, (j + 0.5113) * step.y, (k + 0.4877) * step.z};
      field.values(points, values);
      for (const double v : values) inside += v < 0;
    }
  return inside * step.x * step.y * step.z;
}

}  // namespace meso::implicit
