// SPDX-License-Identifier: Apache-2.0
#include "deep_verify.hpp"

#include <algorithm>

#include "import_membership.hpp"
#include "meso/base/number.hpp"
#include "meso/brep/audit.hpp"
#include "meso/brep/placement.hpp"
#include "meso/brep/triangles.hpp"
#include "meso/membership/crossings.hpp"
#include "meso/membership/volume_estimate.hpp"

namespace meso::operations {
namespace {

using membership::Answer;
using membership::JitteredPoints;

constexpr double identity_tolerance = 1e-6;  ///< relative, of volumes that are integrals of the same faces

std::string place_text(Vec3 p) { return format_number(p.x) + " " + format_number(p.y) + " " + format_number(p.z); }

/// Six digits are enough where a thousandth is in doubt.
std::string rounded(double value) {
  if (value == 0) return "0";
  const double unit = std::pow(10, std::floor(std::log10(std::abs(value))) - 5);
  return format_number(unit < 1 ? std::round(value / unit) / std::round(1 / unit) : std::round(value / unit) * unit);
}

void expect_count(VerifyReport& report, const char* what, std::uint64_t expected, std::uint64_t found) {
  report.checks.push_back({what, std::to_string(expected), std::to_string(found), expected == found});
}

void check_edges(VerifyReport& report, const brep::Body& body) {
  const brep::Audit audit = brep::audit(body);
  expect_count(report, "free edges", 0, audit.free_edges);
  expect_count(report, "multiple edges", 0, audit.multiple_edges);
  expect_count(report, "orientation conflicts", 0, audit.conflicts);
  expect_count(report, "open loops", 0, audit.open_loops);
  expect_count(report, "missing faces", 0, audit.missing_faces);
  expect_count(report, "pieces of shells", audit.shells, audit.components);
}

/// The volume as the integrals of x, y and z over the faces: equal, if and only if nothing is missing anywhere.
Vec3 volumes_by_axis(const brep::Body& body) {
  std::array<long double, 3> total{};
  const auto add = [&](const brep::Shell& shell) {
    std::array<long double, 3> sum{};
    shell.visit([&](const brep::FaceInstance& instance) {
      const brep::FaceMoments& m = shell.geometry->faces[instance.face].moments;
      const Vec3 t = brep::cell_origin(*shell.geometry, instance.cell);
      for (std::size_t i = 0; i < 3; ++i) sum[i] += m.volume_moment[i] + t[i] * m.vector_area[i];
    });
    for (std::size_t i = 0; i < 3; ++i) total[i] += sum[i] * determinant(shell.placement.linear);
  };
  for (const brep::Solid& solid : body.solids) {
    add(solid.outer);
    std::ranges::for_each(solid.voids, add);
  }
  return {static_cast<double>(total[0]), static_cast<double>(total[1]), static_cast<double>(total[2])};
}

void check_integrals(VerifyReport& report, const Made& made, const brep::Measures& measures) {
  const brep::Body& body = made.realisation.body;
  const Vec3 volumes = volumes_by_axis(body);
  const char* names[] = {"volume by x", "volume by y", "volume by z"};
  for (std::size_t i = 0; i < 3; ++i)
    report.checks.push_back({names[i], format_number(measures.volume), format_number(volumes[i]),
                             std::abs(volumes[i] - measures.volume) <= identity_tolerance * std::abs(measures.volume)});
  double of_triangles = 0;
  brep::visit_triangles(body, [&](std::span<const Triangle> block) {
    const Vec3 origin = measures.box.min;
    for (const Triangle& t : block) of_triangles += dot(t[0] - origin, cross(t[1] - origin, t[2] - origin)) / 6;
  });
  const double chords = made.deflection_mm * measures.area;
  report.checks.push_back({"volume of triangles", rounded(measures.volume) + " +- " + rounded(chords),
                           rounded(of_triangles), std::abs(of_triangles - measures.volume) <= chords});
}

/// Cutting one solid leaves that solid and the fragments that were counted.
void check_solids(VerifyReport& report, const Made& made, const Part& part, const brep::Measures& measures,
                  const RunOptions& run) {
  if (!part.macrostructure || part.steps.size() != 1) return;
  const Apply& apply = part.steps.front();
  if (apply.operation == ApplyOperation::union_ || apply.boundary.value_or(BoundaryRule::clip) != BoundaryRule::clip ||
      apply.fragments.value_or(FragmentRule::keep) != FragmentRule::keep)
    return;
  const auto& all = made.evaluation.document().macrostructures;
  const auto found =
      std::ranges::find(all, part.macrostructure->text, [](const Macrostructure& m) { return m.id.text; });
  if (found == all.end()) return;
  DiagnosticSink ignored;
  const auto before = brep::realise_macrostructure(made.evaluation, *found, {.run = run}, ignored);
  if (before && before->solids.size() == 1)
    expect_count(report, "solids", 1 + made.realisation.body.fragments, measures.solids);
}

class PointChecks {
 public:
  PointChecks(VerifyReport& report, const Made& made, const brep::Measures& measures,
              const membership::Membership& judge, const ImportedBodies& imports, const RunOptions& run)
      : report_(report), made_(made), measures_(measures), judge_(judge), imports_(imports), run_(run) {}

  /// False: the run was stopped.
  bool check(const DeepCheck& deep) {
    const Box3 box = searched_box();
    const JitteredPoints points(box, deep.points, deep.seed);
    const auto answers = membership::answers_at(judge_, points, run_);
    if (!answers) return false;
    Check volume = volume_check(points, *answers);
    if (!volume.passed) {  // three deviations are exceeded by chance in one of 400 parts
      const JitteredPoints more(box, 4 * deep.points, deep.seed + 1);
      const auto again = membership::answers_at(judge_, more, run_);
      if (!again) return false;
      volume = volume_check(more, *again);
    }
    report_.checks.push_back(std::move(volume));
    return check_each(points, *answers);
  }

 private:
  /// Around the body and around what it should be.
  [[nodiscard]] Box3 searched_box() const {
    Box3 box = measures_.box;
    if (const auto expected = judge_.box(); expected && !expected->empty()) {
      box.extend(expected->min);
      box.extend(expected->max);
    }
    const Vec3 margin = 0.01 * (box.max - box.min);
    return {box.min - margin, box.max + margin};
  }

  [[nodiscard]] Check volume_check(const JitteredPoints& points, const std::vector<Answer>& answers) const {
    const membership::VolumeEstimate v = membership::estimate_volume(points, answers);
    const double allowed = 3 * v.deviation + imports_.error_mm3();
    std::string expected = rounded(v.low);
    if (v.high > v.low) expected += " to " + rounded(v.high);
    return {"volume by points", expected + " +- " + rounded(allowed), rounded(measures_.volume),
            measures_.volume >= v.low - allowed && measures_.volume <= v.high + allowed};
  }

  /// Every point against the body's triangles. Where the two disagree the point must be near a surface.
  bool check_each(const JitteredPoints& points, const std::vector<Answer>& answers) {
    std::vector<Vec3> places(points.size());
    for (std::size_t i = 0; i < places.size(); ++i) places[i] = points[i];
    const auto inside = membership::inside_of(brep::triangles_of(made_.realisation.body), places, run_);
    if (run_.should_stop()) return false;
    const double near = 2.5 * (made_.deflection_mm + imports_.error_mm());
    std::size_t wrong = 0, judged = 0;
    std::string first;
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (answers[i] == Answer::unknown) continue;
      ++judged;
      if (membership::known(inside[i]) == answers[i] || judge_.clear_at(places[i], near) == Answer::unknown) continue;
      if (wrong++ == 0) first = std::string(inside[i] ? ", outside" : ", inside") + " at " + place_text(places[i]);
    }
    report_.checks.push_back(
        {"points misjudged", "0 of " + std::to_string(judged), std::to_string(wrong) + first, wrong == 0});
    return true;
  }

  VerifyReport& report_;
  const Made& made_;
  const brep::Measures& measures_;
  const membership::Membership& judge_;
  const ImportedBodies& imports_;
  const RunOptions& run_;
};

}  // namespace

bool check_deep(VerifyReport& report, const Made& made, const Part& part, const DeepCheck& deep, const RunOptions& run,
                DiagnosticSink& sink) {
  const brep::Measures measures = brep::measure(made.realisation.body);
  check_edges(report, made.realisation.body);
  check_integrals(report, made, measures);
  check_solids(report, made, part, measures, run);
  ImportedBodies imports(run, sink);
  const auto judge = membership::Membership::make(
      made.evaluation, part,
      {.imports = [&](const eval::ImportShape& import) { return imports.read(import); }, .run = run}, sink);
  if (!judge) return false;
  if (PointChecks(report, made, measures, *judge, imports, run).check(deep)) return true;
  sink.report({.code = run.out_of_time() ? Code::limit_time : Code::cancelled});
  return false;
}

}  // namespace meso::operations
