// SPDX-License-Identifier: Apache-2.0
#include "deep_verify.hpp"

#include <algorithm>
#include <cmath>

#include "half_edge_sum.hpp"
#include "meso/base/number.hpp"
#include "meso/brep/audit.hpp"
#include "meso/brep/gaps.hpp"
#include "meso/brep/placement.hpp"
#include "meso/brep/triangles.hpp"
#include "point_checks.hpp"
#include "prepare.hpp"
#include "read_back.hpp"

namespace meso::operations {
namespace {

constexpr double identity_tolerance = 1e-6;   ///< relative, of volumes that are integrals of the same faces
constexpr double read_back_tolerance = 2e-5;  ///< relative: B-spline faces have approximated curves when read
// Between edges and faces whichever is more.
constexpr double largest_gap_mm = 1e-4, largest_gap_of_cell = 1e-3;
constexpr double missed_deflection = 3;  ///< OpenCASCADE's mesher aims at a deflection and can miss it threefold

class DeepChecks {
 public:
  DeepChecks(VerifyReport& report, const Made& made, const Part& part, const RunOptions& run, DiagnosticSink& sink)
      : report_(report), made_(made), part_(part), body_(made.realisation.body), run_(run), sink_(sink) {}

  /// False with a diagnostic: something could not be looked at.
  bool run(const DeepCheck& deep) {
    figures_.part = part_.id.text;
    figures_.shells_volume = measures_.volume;
    figures_.pieces_volume = body_.pieces_volume;
    figures_.solids = measures_.solids;
    figures_.fragments = body_.fragments;
    check_edges();
    check_gaps();
    check_integrals();
    check_triangles();
    check_solids();
    const bool done = check_read_back(deep) && check_points(report_, figures_, made_, part_, deep, run_, sink_);
    report_.deep.push_back(std::move(figures_));
    return done;
  }

 private:
  void expect_count(const char* what, std::uint64_t expected, std::uint64_t found) {
    report_.checks.push_back({what, std::to_string(expected), std::to_string(found), expected == found});
  }
  void expect_volume(const char* what, double expected, double found, double relative) {
    report_.checks.push_back({what, format_number(expected), format_number(found),
                              std::abs(found - expected) <= relative * std::abs(expected)});
  }

  void check_edges() {
    const brep::Audit audit = brep::audit(body_);
    expect_count("free edges", 0, audit.free_edges);
    expect_count("multiple edges", 0, audit.multiple_edges);
    expect_count("orientation conflicts", 0, audit.conflicts);
    expect_count("open loops", 0, audit.open_loops);
    expect_count("missing faces", 0, audit.missing_faces);
    expect_count("pieces of shells", audit.shells, audit.components);
  }

  void check_gaps() {
    gaps_ = brep::measure_gaps(body_);
    figures_.edge_gap = gaps_.edge_mm;
    figures_.vertex_gap = gaps_.vertex_mm;
    const double allowed =
        std::max(largest_gap_mm, largest_gap_of_cell * smallest_cell_edge(made_.evaluation).value_or(0));
    const auto expect_small = [&](const char* what, double gap) {
      report_.checks.push_back({what, "<= " + rounded(allowed) + " mm", rounded(gap) + " mm", gap <= allowed});
    };
    expect_small("edges from faces", gaps_.edge_mm);
    expect_small("vertices from edges", gaps_.vertex_mm);
  }

  /// As the integrals of x, y and z over the faces: equal, if and only if nothing is missing anywhere. About each
  /// shell's middle: edges that are known to 1e-7 mm count for no more where it is far from the origin.
  [[nodiscard]] std::array<double, 3> volumes_by_axis() const {
    std::array<long double, 3> total{};
    const auto add = [&](const brep::Shell& shell) {
      std::array<long double, 3> sum{}, area{};
      Box3 box;
      shell.visit([&](const brep::FaceInstance& instance) {
        const brep::FaceMoments& m = shell.geometry->faces[instance.face].moments;
        const Vec3 t = brep::cell_origin(*shell.geometry, instance.cell);
        for (std::size_t i = 0; i < 3; ++i) {
          sum[i] += m.volume_moment[i] + t[i] * m.vector_area[i];
          area[i] += m.vector_area[i];
        }
        const Box3& of_face = shell.geometry->faces[instance.face].box;
        box.extend(of_face.min + t);
        box.extend(of_face.max + t);
      });
      for (std::size_t i = 0; i < 3; ++i) sum[i] -= 0.5 * (box.min[i] + box.max[i]) * area[i];
      for (std::size_t i = 0; i < 3; ++i) total[i] += sum[i] * determinant(shell.placement.linear);
    };
    for (const brep::Solid& solid : body_.solids) {
      add(solid.outer);
      std::ranges::for_each(solid.voids, add);
    }
    return {static_cast<double>(total[0]), static_cast<double>(total[1]), static_cast<double>(total[2])};
  }

  void check_integrals() {
    if (body_.pieces_volume > 0)
      expect_volume("volume of pieces", body_.pieces_volume, measures_.volume, identity_tolerance);
    else
      report_.notes.push_back("volume of pieces: booleans have joined them, each of which compares the two itself");
    const std::array<double, 3> volumes = volumes_by_axis();
    const char* names[] = {"volume by x", "volume by y", "volume by z"};
    // Faces end where their edges are, known as those are: that moves a volume by no more than this times the area.
    const double by_edges = gaps_.edge_mm * measures_.area / std::abs(measures_.volume);
    for (std::size_t i = 0; i < 3; ++i)
      expect_volume(names[i], measures_.volume, volumes[i], identity_tolerance + by_edges);
    figures_.shell_volumes = shell_volumes(body_);
  }

  /// Triangles cut corners off; how much, is measured triangle by triangle. A tenth of that covers what lies beyond two
  /// faces at their common edge. The volume tells whether triangles are missing, the distance whether they are near.
  void check_triangles() {
    const Vec3 origin = measures_.box.min;
    double volume = 0;
    HalfEdgeSum half_edges;
    brep::visit_triangles(body_, [&](std::span<const Triangle> block) {
      for (const Triangle& t : block) {
        volume += dot(t[0] - origin, cross(t[1] - origin, t[2] - origin)) / 6;
        half_edges.add(t);
      }
    });
    figures_.triangles_volume = volume;
    figures_.triangles_gap_volume = gaps_.triangles_mm3;
    const double allowed = 0.1 * gaps_.triangles_abs_mm3 + identity_tolerance * std::abs(measures_.volume);
    const double with_gap = volume + gaps_.triangles_mm3;
    report_.checks.push_back({"volume of triangles", rounded(measures_.volume) + " +- " + rounded(allowed),
                              rounded(volume) + " + " + rounded(gaps_.triangles_mm3) + " up to the faces",
                              std::abs(with_gap - measures_.volume) <= allowed});
    figures_.triangle_gap = gaps_.triangle_mm;
    figures_.deflection = made_.deflection_mm;
    const double furthest = missed_deflection * made_.deflection_mm;
    report_.checks.push_back({"triangles from faces", "<= " + rounded(furthest) + " mm",
                              rounded(gaps_.triangle_mm) + " mm", gaps_.triangle_mm <= furthest});
    if (!half_edges.is_balanced())
      figures_.unmatched_half_edges = count_unmatched_half_edges(brep::triangles_of(body_));
    expect_count("unmatched half-edges", 0, figures_.unmatched_half_edges);
  }

  /// Cutting one solid leaves that solid and the fragments that were counted.
  void check_solids() {
    if (!part_.macrostructure || part_.steps.size() != 1) return;
    const Apply& apply = part_.steps.front();
    const auto fragments = apply.fragments.value_or(FragmentRule::keep);
    if (apply.operation == ApplyOperation::union_ || apply.boundary.value_or(BoundaryRule::clip) != BoundaryRule::clip)
      return;
    const auto& all = made_.evaluation.document().macrostructures;
    const auto found =
        std::ranges::find(all, part_.macrostructure->text, [](const Macrostructure& m) { return m.id.text; });
    if (found == all.end()) return;
    DiagnosticSink ignored;
    const auto before = brep::realise_macrostructure(made_.evaluation, *found, {.run = run_}, ignored);
    if (before && before->solids.size() == 1)
      expect_count("solids", 1 + (fragments == FragmentRule::keep ? body_.fragments : 0), measures_.solids);
  }

  /// In plane faces: OpenCASCADE's reader projects every edge of a free form onto it.
  [[nodiscard]] std::uint64_t cost_of_reading() const {
    constexpr std::uint64_t cost_of_free_form = 20;
    std::uint64_t cost = 0;
    const auto add = [&](const brep::Shell& shell) {
      shell.visit([&](const brep::FaceInstance& instance) {
        const brep::Surface& surface = shell.geometry->faces[instance.face].surface;
        cost += std::holds_alternative<brep::BSplineSurface>(surface) ? cost_of_free_form : 1;
      });
    };
    for (const brep::Solid& solid : body_.solids) {
      add(solid.outer);
      std::ranges::for_each(solid.voids, add);
    }
    return cost;
  }

  bool check_read_back(const DeepCheck& deep) {
    if (cost_of_reading() > deep.most_faces_read_back) {
      report_.notes.push_back("STEP read back: left out, OpenCASCADE takes minutes to read these " +
                              std::to_string(measures_.faces) + " faces");
      return true;
    }
    DiagnosticSink told;
    const auto read = read_back(body_, run_, told);
    if (run_.should_stop())
      return sink_.report({.code = run_.out_of_time() ? Code::limit_time : Code::cancelled}), false;
    if (!read) {
      report_.checks.push_back({"STEP read back", "closed solids",
                                told.diagnostics().empty() ? "none" : message(told.diagnostics().front()), false});
      return true;
    }
    expect_count("STEP read back, solids", measures_.solids, read->solids.size());
    figures_.read_back_volumes = shell_volumes(*read);
    const std::vector<double>&own = figures_.shell_volumes, &theirs = figures_.read_back_volumes;
    expect_count("STEP read back, shells", own.size(), theirs.size());
    std::size_t differing = 0;
    for (std::size_t i = 0; i < std::min(own.size(), theirs.size()); ++i)
      differing += std::abs(own[i] - theirs[i]) > read_back_tolerance * std::abs(own[i]);
    expect_count("STEP read back, volumes", 0, differing);
    return true;
  }

  VerifyReport& report_;
  const Made& made_;
  const Part& part_;
  const brep::Body& body_;
  const RunOptions& run_;
  DiagnosticSink& sink_;
  const brep::Measures measures_ = brep::measure(body_);
  brep::Gaps gaps_;
  DeepFigures figures_;
};

}  // namespace

bool check_deep(VerifyReport& report, const Made& made, const Part& part, const DeepCheck& deep, const RunOptions& run,
                DiagnosticSink& sink) {
  return DeepChecks(report, made, part, run, sink).run(deep);
}

}  // namespace meso::operations
