// SPDX-License-Identifier: Apache-2.0
#include "point_checks.hpp"

#include <algorithm>
#include <cmath>

#include "import_membership.hpp"
#include "meso/base/number.hpp"
#include "meso/brep/triangles.hpp"
#include "meso/membership/crossings.hpp"
#include "meso/membership/volume_estimate.hpp"
#include "meso/mesh/closest_point.hpp"

namespace meso::operations {
namespace {

using membership::Answer;
using membership::JitteredPoints;

// So that an error of half a percent lies five deviations off.
constexpr double wanted_deviation = 1e-3;  ///< of the volume
constexpr double widest_unknown = 0.01;    ///< of the volume, that points cannot judge
constexpr std::size_t first_points = 2'000'000, most_points = 100'000'000;

std::string place_text(Vec3 p) { return format_number(p.x) + " " + format_number(p.y) + " " + format_number(p.z); }

class PointChecks {
 public:
  PointChecks(VerifyReport& report, DeepFigures& figures, const Made& made, const membership::Membership& judge,
              const ImportedBodies& imports, const RunOptions& run)
      : report_(report), figures_(figures), made_(made), judge_(judge), imports_(imports), run_(run) {}

  /// False: the run was stopped.
  bool check(const DeepCheck& deep) {
    const Box3 box = searched_box();
    const JitteredPoints points(box, deep.points.value_or(first_points), deep.seed);
    const auto answers = membership::answers_at(judge_, points, run_);
    if (!answers) return false;
    take(points, membership::estimate_volume(points, *answers), deep.seed);
    if (!deep.points && figures_.sigma > wanted_deviation * volume()) {
      // The deviation shrinks at least with the root of the number.
      const double more = std::pow(figures_.sigma / (wanted_deviation * volume()), 2);
      const auto count =
          static_cast<std::size_t>(std::min(more * static_cast<double>(points.size()), 1.0 * most_points));
      if (!count_again(box, count, deep.seed)) return false;
    }
    // Three deviations are exceeded by chance in one of 400 parts.
    if (!volume_passes() && !count_again(box, 4 * figures_.points, deep.seed + 1)) return false;
    tell_volume();
    return check_each(points, *answers);
  }

 private:
  [[nodiscard]] double volume() const { return figures_.shells_volume; }
  [[nodiscard]] double allowed() const { return 3 * figures_.sigma + imports_.error_mm3(); }
  [[nodiscard]] bool volume_passes() const { return std::abs(figures_.difference) <= allowed(); }

  /// Between limits that are far apart nearly everything lies: that is no check.
  void tell_volume() {
    const double low = figures_.points_volume, high = figures_.points_volume_high;
    const std::string expected = rounded(low) + (high > low ? " to " + rounded(high) : "");
    if (volume_passes() && high - low > widest_unknown * high) {
      report_.notes.push_back("volume by points: not checked, points tell " + expected + " mm3 at most, found " +
                              rounded(volume()) + "; the rest they cannot judge (dropped fragments, for one)");
      return;
    }
    report_.checks.push_back({"volume by points", expected + " +- " + rounded(allowed()) + " (3 sigma)",
                              rounded(volume()) + " (" + (figures_.difference < 0 ? "" : "+") +
                                  rounded(figures_.difference / figures_.sigma) + " sigma)",
                              volume_passes()});
  }

  void take(const JitteredPoints& points, const membership::VolumeEstimate& v, std::uint64_t seed) {
    figures_.points = points.size();
    figures_.seed = seed;
    figures_.points_volume = v.low;
    figures_.points_volume_high = v.high;
    figures_.sigma = v.deviation;
    figures_.difference = volume() - std::clamp(volume(), v.low, v.high);
  }

  bool count_again(const Box3& box, std::size_t count, std::uint64_t seed) {
    const JitteredPoints points(box, count, seed);
    const auto estimate = membership::estimate_volume(judge_, points, run_);
    if (estimate) take(points, *estimate, seed);
    return estimate.has_value();
  }

  /// Around the body and around what it should be.
  [[nodiscard]] Box3 searched_box() const {
    Box3 box = brep::measure(made_.realisation.body).box;
    if (const auto expected = judge_.box(); expected && !expected->empty()) {
      box.extend(expected->min);
      box.extend(expected->max);
    }
    const Vec3 margin = 0.01 * (box.max - box.min);
    return {box.min - margin, box.max + margin};
  }

  /// Every point against the body's triangles. Where the two disagree the point must be near a surface.
  bool check_each(const JitteredPoints& points, const std::vector<Answer>& answers) {
    std::vector<Vec3> places(points.size());
    for (std::size_t i = 0; i < places.size(); ++i) places[i] = points[i];
    const auto inside = membership::inside_of(brep::triangles_of(made_.realisation.body), places, run_);
    if (run_.should_stop()) return false;
    const double near = 2.5 * (made_.deflection_mm + imports_.error_mm());
    std::size_t judged = 0, judged_inside = 0;
    std::vector<std::size_t> wrong;
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (answers[i] == Answer::unknown) continue;
      ++judged;
      judged_inside += answers[i] == Answer::inside;
      if (membership::known(inside[i]) == answers[i] || judge_.clear_at(places[i], near) == Answer::unknown) continue;
      wrong.push_back(i);
    }
    forget_near_triangles(wrong, places, near);
    if (run_.should_stop()) return false;
    if (judged_inside == 0)
      report_.notes.push_back("points misjudged: no point inside could be judged, " + std::to_string(judged) +
                              " outside were");
    if (judged == 0) return true;
    std::string found = std::to_string(wrong.size());
    if (!wrong.empty())
      found += (inside[wrong.front()] ? ", outside at " : ", inside at ") + place_text(places[wrong.front()]);
    report_.checks.push_back({"points misjudged", "0 of " + std::to_string(judged), found, wrong.empty()});
    return true;
  }

  /// Where rounded bodies touch, what is asked around a point hops over the gap between them; the triangles do not.
  /// What is nearer to its own triangles than `near` is therefore none; of very many points, the first ones speak for
  /// all.
  void forget_near_triangles(std::vector<std::size_t>& wrong, const std::vector<Vec3>& places, double near) const {
    constexpr std::size_t most_asked = 2'000;
    const std::size_t asked = std::min(wrong.size(), most_asked);
    if (asked == 0) return;
    std::vector<bool> is_near(asked, false);
    const Vec3 margin{near, near, near};
    brep::triangles_of(made_.realisation.body)([&](std::span<const Triangle> block) {
      if (run_.should_stop()) return;
      for (const Triangle& t : block) {
        Box3 box;
        for (const Vec3 corner : t) box.extend(corner);
        box = {box.min - margin, box.max + margin};
        for (std::size_t k = 0; k < asked; ++k) {
          const Vec3 p = places[wrong[k]];
          if (!is_near[k] && box.intersects({p, p}) && norm(to_closest_point(t, p)) <= near) is_near[k] = true;
        }
      }
    });
    if (std::ranges::all_of(is_near, std::identity())) return wrong.clear();
    std::size_t kept = 0;
    for (std::size_t k = 0; k < wrong.size(); ++k)
      if (k >= asked || !is_near[k]) wrong[kept++] = wrong[k];
    wrong.resize(kept);
  }

  VerifyReport& report_;
  DeepFigures& figures_;
  const Made& made_;
  const membership::Membership& judge_;
  const ImportedBodies& imports_;
  const RunOptions& run_;
};

}  // namespace

std::string rounded(double value) {
  if (value == 0 || !std::isfinite(value)) return format_number(value);
  const double unit = std::pow(10, std::floor(std::log10(std::abs(value))) - 5);
  return format_number(unit < 1 ? std::round(value / unit) / std::round(1 / unit) : std::round(value / unit) * unit);
}

bool check_points(VerifyReport& report, DeepFigures& figures, const Made& made, const Part& part, const DeepCheck& deep,
                  const RunOptions& run, DiagnosticSink& sink) {
  ImportedBodies imports(run, sink);
  const auto judge =
      membership::Membership::make(made.evaluation, part,
                                   {.imports = [&](const eval::ImportShape& import) { return imports.read(import); },
                                    .run = run,
                                    .no_fragments = made.realisation.cells.fragments == 0},
                                   sink);
  if (!judge) return false;
  if (PointChecks(report, figures, made, *judge, imports, run).check(deep)) return true;
  sink.report({.code = run.out_of_time() ? Code::limit_time : Code::cancelled});
  return false;
}

}  // namespace meso::operations
