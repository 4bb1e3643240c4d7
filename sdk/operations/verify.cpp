// SPDX-License-Identifier: Apache-2.0
#include "meso/operations/verify.hpp"

#include <algorithm>
#include <cmath>

#include "audit_files.hpp"
#include "deep_verify.hpp"
#include "meso/base/number.hpp"
#include "meso/brep/audit.hpp"
#include "meso/brep/read_step.hpp"
#include "meso/brep/triangles.hpp"
#include "meso/membership/crossings.hpp"
#include "meso/package/open_document.hpp"
#include "prepare.hpp"
#include "read_mesh.hpp"

namespace meso::operations {
namespace fs = std::filesystem;
namespace {

void check_number(VerifyReport& report, const std::string& what, double expected, double found, double tolerance) {
  report.checks.push_back(
      {what, format_number(expected), format_number(found), std::abs(found - expected) <= tolerance});
}

void check_count(VerifyReport& report, const std::string& what, std::optional<std::int64_t> expected,
                 std::uint64_t found) {
  if (!expected) return;
  report.checks.push_back({what, std::to_string(*expected), std::to_string(found),
                           *expected >= 0 && static_cast<std::uint64_t>(*expected) == found});
}

double relative(const std::optional<double>& tolerance, double value) {
  return tolerance.value_or(1e-6) * std::max(1e-300, std::abs(value));
}

/// Compares one realised part with its stated values; those are in the document's unit.
void check_part(VerifyReport& report, const Validation& expected, const Made& made) {
  const double mm = millimeters_per(made.evaluation.document().unit);
  const brep::Body& body = made.realisation.body;
  const brep::Measures measures = brep::measure(body);
  if (expected.volume) {
    const double volume = measures.volume / (mm * mm * mm);
    check_number(report, "volume", expected.volume->value, volume,
                 relative(expected.volume->tolerance, expected.volume->value));
  }
  if (expected.area) {
    check_number(report, "area", expected.area->value, measures.area / (mm * mm),
                 relative(expected.area->tolerance, expected.area->value));
  }
  if (expected.centroid) {
    const ExpectedCentroid& c = *expected.centroid;
    const double tolerance = c.tolerance.value_or(1e-6);
    check_number(report, "centroid.x", c.x, measures.centroid.x / mm, tolerance);
    check_number(report, "centroid.y", c.y, measures.centroid.y / mm, tolerance);
    check_number(report, "centroid.z", c.z, measures.centroid.z / mm, tolerance);
  }
  if (expected.count) {
    check_count(report, "placed", expected.count->placed, made.realisation.cells.placed);
    check_count(report, "kept", expected.count->kept, made.realisation.cells.kept);
    check_count(report, "solids", expected.count->solids, measures.solids);
    check_count(report, "fragments", expected.count->fragments, body.fragments);
  }
  std::vector<Vec3> points;
  for (const SamplePoint& s : expected.samples) points.push_back(mm * Vec3{s.x, s.y, s.z});
  const std::vector<bool> inside = membership::inside_of(brep::triangles_of(body), points, {});
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool stated = expected.samples[i].inside;
    report.checks.push_back({"sample " + std::to_string(i + 1), stated ? "inside" : "outside",
                             inside[i] ? "inside" : "outside", stated == inside[i]});
  }
}

/// The parts to look at: the one that is asked for; else those with validation values, and where that is not enough
/// those that are built.
std::vector<const Part*> parts_to_check(const Document& document, const std::string& only, bool deep) {
  const auto is_built = [&](const Part& part) {
    return document.parts.size() == 1 ||
           std::ranges::any_of(document.build, [&](const BuildItem& item) { return item.part.text == part.id.text; });
  };
  std::vector<const Part*> out;
  for (const Part& part : document.parts) {
    if (!only.empty() && part.id.text != only) continue;
    if (part.validation || (deep && (!only.empty() || is_built(part)))) out.push_back(&part);
  }
  return out;
}

/// Finer than what is written to files, so that thin struts are thicker than the doubt near a surface.
constexpr double deep_fineness = 0.25;

bool check_one(VerifyReport& report, const fs::path& file, const Part& part, MakeOptions options,
               const std::optional<DeepCheck>& deep, DiagnosticSink& sink) {
  options.part = part.id.text;
  options.mesh = deep || !part.validation->samples.empty();
  if (deep) {
    const auto prepared = prepare(file, options, sink);
    if (!prepared) return false;
    options.deflection_mm = deep_fineness * prepared->realise.deflection_mm;
  }
  const auto made = make_body(file, options, sink);
  if (!made) return false;
  if (part.validation) check_part(report, *part.validation, *made);
  report.measures = brep::measure(made->realisation.body);
  const bool closed = brep::audit(made->realisation.body).clean();
  report.closed = report.closed && closed;
  report.checks.push_back({"closed " + part.id.text, "yes", closed ? "yes" : "no", closed});
  return !deep || check_deep(report, *made, part, *deep, options.run, sink);
}

std::optional<VerifyReport> verify_document(const fs::path& file, const MakeOptions& options,
                                            const std::optional<DeepCheck>& deep, DiagnosticSink& sink) {
  const auto checked = open_checked_document(file, options.run, sink);
  if (!checked) return std::nullopt;
  VerifyReport report{.closed = true};
  const auto parts = parts_to_check(checked->document(), options.part, deep.has_value());
  if (parts.empty()) {
    sink.report({.code = Code::verify_nothing_stated, .where = {.file = file.string()}});
    return std::nullopt;
  }
  for (const Part* part : parts)
    if (!check_one(report, file, *part, options, deep, sink)) return std::nullopt;
  return report;
}

}  // namespace

bool VerifyReport::passed() const {
  return std::all_of(checks.begin(), checks.end(), [](const Check& c) { return c.passed; });
}

std::optional<VerifyReport> verify(const fs::path& file, const MakeOptions& options,
                                   const std::optional<DeepCheck>& deep, DiagnosticSink& sink) {
  std::optional<VerifyReport> report;
  if (is_mesh_file(file)) {
    report = audit_mesh_file(file, options.run, sink);
  } else if (brep::is_exact_file(file)) {
    report = audit_step(file, deep.has_value(), options.run, sink);
  } else {
    report = verify_document(file, options, deep, sink);
  }
  if (report && !report->passed()) {
    const auto failed =
        std::count_if(report->checks.begin(), report->checks.end(), [](const Check& c) { return !c.passed; });
    sink.report({.code = Code::verify_failed,
                 .where = {.file = file.string()},
                 .args = {std::to_string(failed), std::to_string(report->checks.size())}});
  }
  return report;
}

}  // namespace meso::operations
