// SPDX-License-Identifier: Apache-2.0
#include "audit_files.hpp"

#include <fstream>
#include <iterator>

#include "meso/base/number.hpp"
#include "meso/brep/audit.hpp"
#include "meso/brep/read_step.hpp"
#include "meso/import_surface_mesh/read_surface_mesh.hpp"
#include "meso/mesh/audit_mesh.hpp"
#include "meso/mesh/self_contact.hpp"

namespace meso::operations {
namespace {

void expect_none(VerifyReport& report, const char* what, std::uint64_t found) {
  report.checks.push_back({what, "0", std::to_string(found), found == 0});
}

void expect_positive(VerifyReport& report, double volume) {
  report.checks.push_back({"volume", "> 0", format_number(volume), volume > 0});
}

void check_self_contact(VerifyReport& report, const TriangleMesh& mesh) {
  const SelfContacts contacts = count_self_contacts(mesh, 1000);
  std::string found = std::to_string(contacts.pairs) + (contacts.pairs == 1000 ? " or more" : "");
  if (const auto& p = contacts.first_place) {
    found += " near " + format_number(p->x) + " " + format_number(p->y) + " " + format_number(p->z);
  }
  report.checks.push_back({"self-contacts", "0", found, contacts.pairs == 0});
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
  check_self_contact(report, *mesh);
  return report;
}

std::optional<VerifyReport> audit_step(const std::filesystem::path& file, const RunOptions& run, DiagnosticSink& sink) {
  // Contact is looked for between triangles a thousandth of the part's size from the surface.
  const auto body = brep::read_step(file, {.relative_deflection = 1e-3}, run, sink);
  if (!body) return std::nullopt;
  const brep::Audit audit = brep::audit(*body);
  VerifyReport report{.measures = brep::measure(*body), .closed = audit.clean()};
  expect_none(report, "free edges", audit.free_edges);
  expect_none(report, "multiple edges", audit.multiple_edges);
  expect_none(report, "orientation conflicts", audit.conflicts);
  expect_none(report, "open loops", audit.open_loops);
  expect_positive(report, report.measures.volume);
  check_self_contact(report, triangle_mesh(*body));
  return report;
}

}  // namespace meso::operations
