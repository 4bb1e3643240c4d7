// SPDX-License-Identifier: Apache-2.0
#include "audit_files.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "meso/base/number.hpp"
#include "meso/brep/audit.hpp"
#include "meso/brep/gaps.hpp"
#include "meso/brep/read_step.hpp"
#include "meso/brep/step_text.hpp"
#include "meso/brep/triangle_mesh.hpp"
#include "meso/import_surface_mesh/read_surface_mesh.hpp"
#include "meso/mesh/audit_mesh.hpp"
#include "meso/mesh/self_contact.hpp"
#include "meso/resource/resource.hpp"
#include "point_checks.hpp"
#include "read_back.hpp"
#include "step_outline.hpp"

namespace meso::operations {
namespace {

void expect_none(VerifyReport& report, const char* what, std::uint64_t found) {
  report.checks.push_back({what, "0", std::to_string(found), found == 0});
}

void expect_positive(VerifyReport& report, double volume) {
  report.checks.push_back({"volume", "> 0", format_number(volume), volume > 0});
}

/// What chords explain is told and no fault.
void check_self_contact(VerifyReport& report, const TriangleMesh& mesh, const std::vector<double>& heights) {
  constexpr std::uint64_t limit = 1000;
  const SelfContacts contacts = count_self_contacts(mesh, heights, limit);
  std::string where;
  if (const auto& p = contacts.place)
    where = ", the deepest of " + rounded(contacts.deepest_mm) + " mm near " + rounded(p->x) + " " + rounded(p->y) +
            " " + rounded(p->z);
  const bool is_clear = contacts.deep == 0;
  const std::string count = std::to_string(contacts.deep) + (contacts.deep == limit ? " or more" : "");
  report.checks.push_back({"self-contacts", "0", is_clear ? count : count + where, is_clear});
  if (is_clear && contacts.pairs > 0)
    report.notes.push_back("self-contacts: " + std::to_string(contacts.pairs) +
                           " pairs of triangles pass through each other" + where +
                           ": no more than chords of surfaces that keep apart can");
}

}  // namespace

std::optional<VerifyReport> audit_mesh_file(const std::filesystem::path& file, const RunOptions& run,
                                            DiagnosticSink& sink) {
  const auto mesh = read_surface_mesh_file(file, sink, run);
  if (!mesh) return std::nullopt;
  const MeshAudit audit = audit_mesh(*mesh);
  VerifyReport report{.closed = audit.watertight(), .triangles = audit.triangles};
  report.measures.volume = audit.volume;
  report.measures.area = audit.area;
  report.measures.box = audit.box;
  report.measures.shells = audit.components;
  report.measures.solids = audit.components;
  expect_none(report, "unmatched half-edges", audit.unmatched_half_edges);
  expect_none(report, "flipped edges", audit.flipped_edges);
  expect_none(report, "multiple edges", audit.multiple_edges);
  expect_none(report, "degenerate triangles", audit.degenerate);
  expect_positive(report, audit.volume);
  check_self_contact(report, *mesh, chord_heights(*mesh));
  return report;
}

namespace {

/// More than that OpenCASCADE reads only if it is asked for.
constexpr std::uint64_t most_faces_read = 10'000;

/// Whether the file was looked at in this way, and not for OpenCASCADE.
std::optional<VerifyReport> audit_large_step(const std::filesystem::path& file, std::string_view text,
                                             std::uint64_t faces, const RunOptions& run, DiagnosticSink& sink) {
  std::string fault = brep::step_text_fault(text).value_or("");
  const auto outline = fault.empty() ? outline_step(text, run, fault) : std::nullopt;
  if (!outline) {
    if (run.should_stop())
      sink.report({.code = run.out_of_time() ? Code::limit_time : Code::cancelled});
    else
      sink.report({.code = Code::import_unreadable,
                   .args = {file.string(), fault.empty() ? "its shells are not understood" : fault}});
    return std::nullopt;
  }
  VerifyReport report{.measured = false};
  report.measures.solids = outline->solids;
  report.measures.shells = outline->shells;
  report.measures.faces = outline->faces;
  expect_none(report, "free edges", outline->free_edges);
  expect_none(report, "multiple edges", outline->multiple_edges);
  expect_none(report, "orientation conflicts", outline->conflicts);
  expect_none(report, "open loops", outline->open_loops);
  report.closed = report.passed();
  report.notes.push_back("volume, self-contacts: not looked at, OpenCASCADE takes minutes to read " +
                         std::to_string(faces) + " faces; --deep does it all the same");
  return report;
}

constexpr double largest_gap_mm = 1e-4, largest_gap_of_face = 1e-3;

/// The diagonal of a face's box, of which half of the faces have a smaller one: slivers, which lattices have where they
/// are cut, do not count for all.
double median_face_size(const brep::Body& body) {
  std::vector<double> sizes;
  const auto add = [&](const brep::Shell& shell) {
    const double scale = std::cbrt(determinant(shell.placement.linear));
    for (const brep::FaceTemplate& face : shell.geometry->faces)
      sizes.push_back(scale * norm(face.box.max - face.box.min));
  };
  for (const brep::Solid& solid : body.solids) {
    add(solid.outer);
    std::ranges::for_each(solid.voids, add);
  }
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::ranges::nth_element(sizes, middle);
  return middle == sizes.end() ? 0 : *middle;
}

}  // namespace

std::optional<VerifyReport> audit_step(const std::filesystem::path& file, bool deep, const RunOptions& run,
                                       DiagnosticSink& sink) {
  std::string error;
  if (const auto bytes = deep ? nullptr : ResourceBytes::open(Resource(file), error)) {
    const std::uint64_t faces = count_step_faces(bytes->view());
    if (faces > most_faces_read) return audit_large_step(file, bytes->view(), faces, run, sink);
  }
  // Contact is looked for between triangles a thousandth of the part's size from the surface.
  const auto body = brep::read_step(file, {.relative_deflection = 1e-3, .mesh_may_fail = true}, run, sink);
  if (!body) return std::nullopt;
  const brep::Audit audit = brep::audit(*body);
  VerifyReport report{.measures = brep::measure(*body), .closed = audit.clean()};
  expect_none(report, "free edges", audit.free_edges);
  expect_none(report, "multiple edges", audit.multiple_edges);
  expect_none(report, "orientation conflicts", audit.conflicts);
  expect_none(report, "open loops", audit.open_loops);
  expect_positive(report, report.measures.volume);
  const brep::Gaps gaps = brep::measure_gaps(*body);
  const double allowed = std::max(largest_gap_mm, largest_gap_of_face * median_face_size(*body));
  const auto expect_small = [&](const char* what, double gap) {
    report.checks.push_back({what, "<= " + rounded(allowed) + " mm", rounded(gap) + " mm", gap <= allowed});
  };
  expect_small("edges from faces", gaps.edge_mm);
  expect_small("vertices from edges", gaps.vertex_mm);
  report.shell_volumes = shell_volumes(*body);
  const TriangleMesh mesh = brep::triangle_mesh(*body);
  if (!mesh.triangles.empty())
    check_self_contact(report, mesh, std::vector<double>(mesh.triangles.size(), gaps.triangle_mm));
  else
    report.notes.push_back("self-contacts: not looked at, OpenCASCADE has no triangles for some of the faces");
  return report;
}

}  // namespace meso::operations
