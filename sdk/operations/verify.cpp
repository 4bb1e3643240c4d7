// SPDX-License-Identifier: Apache-2.0
#include "meso/operations/verify.hpp"

#include <algorithm>
#include <cmath>

#include "audit_files.hpp"
#include "file_extension.hpp"
#include "meso/base/number.hpp"
#include "meso/brep/audit.hpp"
#include "meso/brep/triangles.hpp"
#include "meso/validate/validate.hpp"
#include "meso/xml/read.hpp"
#include "winding.hpp"

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
  const std::vector<bool> inside = inside_by_winding(brep::triangles_of(body), points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool stated = expected.samples[i].inside;
    report.checks.push_back({"sample " + std::to_string(i + 1), stated ? "inside" : "outside",
                             inside[i] ? "inside" : "outside", stated == inside[i]});
  }
}

/// Ids of the parts with validation values, restricted to --part.
std::vector<std::string> parts_to_check(const Document& document, const std::string& only) {
  std::vector<std::string> out;
  for (const Part& part : document.parts) {
    if (part.validation && (only.empty() || part.id.text == only)) out.push_back(part.id.text);
  }
  return out;
}

std::optional<VerifyReport> verify_document(const fs::path& file, const MakeOptions& options, DiagnosticSink& sink) {
  auto read = read_document_file(file, sink);
  if (!read) return std::nullopt;
  const auto checked = validate(std::move(read->document), std::move(read->source), file.parent_path(), sink);
  if (!checked) return std::nullopt;
  VerifyReport report{.closed = true};
  const auto ids = parts_to_check(checked->document(), options.part);
  if (ids.empty()) {
    sink.report({.code = Code::verify_nothing_stated, .where = {.file = file.string()}});
    return std::nullopt;
  }
  for (const std::string& id : ids) {
    MakeOptions one = options;
    one.part = id;
    const Part& part = *std::find_if(checked->document().parts.begin(), checked->document().parts.end(),
                                     [&](const Part& p) { return p.id.text == id; });
    one.mesh = !part.validation->samples.empty();
    const auto made = make_body(file, one, sink);
    if (!made) return std::nullopt;
    check_part(report, *part.validation, *made);
    report.measures = brep::measure(made->realisation.body);
    const bool closed = brep::audit(made->realisation.body).clean();
    report.closed = report.closed && closed;
    report.checks.push_back({"closed " + id, "yes", closed ? "yes" : "no", closed});
  }
  return report;
}

}  // namespace

bool VerifyReport::passed() const {
  return std::all_of(checks.begin(), checks.end(), [](const Check& c) { return c.passed; });
}

std::optional<VerifyReport> verify(const fs::path& file, const MakeOptions& options, DiagnosticSink& sink) {
  const std::string extension = lower_extension(file);
  std::optional<VerifyReport> report;
  if (extension == ".stl") {
    report = audit_stl(file, sink);
  } else if (extension == ".step" || extension == ".stp") {
    report = audit_step(file, options.run, sink);
  } else {
    report = verify_document(file, options, sink);
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
