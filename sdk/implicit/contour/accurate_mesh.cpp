// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/accurate_mesh.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "counted_source.hpp"
#include "meso/base/memory_mesh_sink.hpp"
#include "meso/base/memory_outlook.hpp"
#include "meso/base/number.hpp"
#include "refine_mesh.hpp"
#include "simplify_mesh.hpp"
#include "untangle_mesh.hpp"

namespace meso::implicit {
namespace {

double largest_spacing(const Grid& grid) { return std::max({grid.spacing(0), grid.spacing(1), grid.spacing(2)}); }

Grid with_spacing(const Box3& box, double spacing) {
  Grid grid{.box = box};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double cells = std::ceil((box.max[axis] - box.min[axis]) / spacing - 1e-6);
    grid.nodes[axis] = static_cast<std::int32_t>(std::clamp(cells + 1, 2.0, 2e9));
  }
  return grid;
}

/// Points of triangles that have a corner in which two sheets meet at less than some 70 degrees: there, a little less
/// is soon too little.
std::vector<char> beside_wedges(const TriangleMesh& mesh) {
  constexpr double turned = -0.3;
  std::vector<Vec3> first(mesh.points.size());
  std::vector<char> at(mesh.points.size(), 0), beside(mesh.points.size(), 0);
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 n = cross(mesh.points[b] - mesh.points[a], mesh.points[c] - mesh.points[a]);
    for (const std::uint32_t p : {a, b, c}) {
      if (norm(first[p]) == 0) first[p] = n;
      if (dot(n, first[p]) < turned * norm(n) * norm(first[p])) at[p] = 1;
    }
  }
  for (const auto& t : mesh.triangles)
    if (std::ranges::any_of(t, [&](std::uint32_t p) { return at[p] != 0; }))
      for (const std::uint32_t p : t) beside[p] = 1;
  return beside;
}

std::string rounded(double value, int digits = 4) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, digits).ptr;
  return {text.data(), end};
}

/// As many digits as a reader wants, and as tell it from the bound that it leaves.
std::string rounded_beyond(double value, double bound) {
  for (int digits = 4; digits < 17; ++digits)
    if (std::string text = rounded(value, digits); parse_number(text).value_or(0) > bound) return text;
  return format_number(value);
}

/// A mesh in memory counts as such.
class WorkingMesh final : public MemoryMeshSink {
 public:
  using MemoryMeshSink::MemoryMeshSink;
  [[nodiscard]] std::uint64_t bytes_per_triangle() const override { return RefinableMesh::bytes_per_triangle; }
};

class Making {
 public:
  Making(const SourceOn& source_on, const AccurateMeshOptions& options, const RunOptions& run,
         DiagnosticSink& diagnostics)
      : source_on_(source_on), options_(options), run_(run), diagnostics_(diagnostics) {}

  std::optional<AccurateMesh> make(Grid grid);

 private:
  std::unique_ptr<GridSource> counted_on(const Grid& grid);
  bool contour_on(const Grid& grid);
  bool to_tolerance(const Grid& first);
  [[nodiscard]] bool is_affordable(const Grid& coarse);
  /// What is seen of a mesh that a grid gives.
  struct Look {
    double astray = 0;         ///< the share of triangles that face otherwise than the surface does
    double distance = 0;       ///< few edges are farther
    double triangles_for = 0;  ///< about how many triangles the tolerance takes
  };
  static constexpr double look_near = 0.29, few = 2e-3, few_astray = 5e-3;
  static constexpr double most_triangles = 8e6, most_finer = 3;  // of grids after the first
  Look look_at(const TriangleMesh& mesh, double spacing);
  [[nodiscard]] static double farthest_on(const Grid& grid);
  bool resolve(Grid grid);
  /// What refining comes to where it does not mend what is far.
  struct Stubborn {
    std::size_t far = 0;
    double distance = HUGE_VAL;
    int rounds = 0;  ///< that made it worse
    std::optional<RefinableMesh> closest{};
  };
  bool gets_no_closer(Stubborn& so_far, std::size_t halved) const;
  enum class Refined { done, stopped, too_large };
  Refined refine();
  bool refine_or_tell();
  bool take_refined();
  bool thin();
  bool simplify();
  bool takes_over(double bound, std::vector<char>& kept);
  void measure_marked(TriangleMesh mesh, std::span<const char> marked, double bound);
  bool untangle();
  void measure(TriangleMesh mesh, bool may_move, double tolerance);
  [[nodiscard]] Diagnostic not_reached(double bound) const;
  [[nodiscard]] Diagnostic takes(double triangles, double least_bytes = 0) const;
  void pass_on(const DiagnosticSink& told);
  [[nodiscard]] double finer_for(double distance, double most) const;
  [[nodiscard]] double triangles_of_finer(double distance) const;
  void expect(double triangles);
  void tell_of(double triangles);
  [[nodiscard]] bool fits(double triangles);
  /// The same; tells where it does not.
  [[nodiscard]] bool affords(double triangles);
  // What normals tell, and what lies between the points that are looked at, is off by a part of it.
  [[nodiscard]] double aim() const { return is_smooth() ? 0.7 * options_.tolerance : options_.tolerance; }
  [[nodiscard]] bool is_smooth() const { return options_.tolerance > 0 && !options_.sharp; }
  bool go_on();
  [[nodiscard]] std::function<bool()> not_stopped() const {
    return [this] { return !run_.should_stop(); };
  }

  const SourceOn& source_on_;
  const AccurateMeshOptions& options_;
  const RunOptions& run_;
  DiagnosticSink& diagnostics_;
  AccurateMesh out_;
  double grid_triangles_ = 0;
  double expected_ = 0;     // triangles of what is under way
  double told_ = 0;         // the most that was told of
  RefinableMesh::Far far_;  // of the mesh that is taken
  std::optional<Diagnostic> left_;
  bool spares_ = false;     // most of the triangles are more than curves ask for
  double finer_takes_ = 0;  // where that will not be enough
  CountedSource::Counts counts_;
  std::unique_ptr<GridSource> source_;
  std::optional<SurfaceFeet> feet_;
  std::optional<RefinableMesh> refinable_;
};

bool Making::go_on() {
  if (!run_.should_stop()) return true;
  diagnostics_.report({.code = run_.out_of_time() ? Code::limit_time : Code::cancelled});
  return false;
}

std::unique_ptr<GridSource> Making::counted_on(const Grid& grid) {
  DiagnosticSink told;
  const bool fits = check_grid(grid, run_, told);
  pass_on(told);
  if (!fits) return nullptr;
  auto source = source_on_(grid);
  return source ? std::make_unique<CountedSource>(std::move(source), counts_) : nullptr;
}

bool Making::contour_on(const Grid& grid) {
  refinable_.reset();
  feet_.reset();
  source_ = counted_on(grid);  // only now: the feet were asked of the one before
  if (!source_) return false;
  out_.grid = grid;
  out_.mesh = {};
  WorkingMesh sink(out_.mesh);
  // Vertices of a smooth surface are moved onto it afterwards, when its gradient there is known.
  DiagnosticSink told;
  const auto report = contour(*source_, sink, {.polish = !is_smooth(), .sharp = options_.sharp}, run_, told);
  pass_on(told);
  if (!report) return false;
  grid_triangles_ = static_cast<double>(out_.mesh.triangles.size());
  out_.euler = report->euler;
  feet_.emplace(*source_, not_stopped());
  return true;
}

void Making::measure(TriangleMesh mesh, bool may_move, double tolerance) {
  refinable_.emplace(std::move(mesh), out_.grid.box, *feet_, may_move && is_smooth());
  if (may_move) refinable_->move_vertices(tolerance);
  if (!is_smooth()) refinable_->measure_points(tolerance);
  refinable_->measure(tolerance);
}

constexpr double bytes_beside = 40 << 20;  // the program, and points that are asked at a time

double bytes_for(double triangles) {
  return bytes_beside + triangles * static_cast<double>(RefinableMesh::bytes_per_triangle);
}

Diagnostic Making::not_reached(double bound) const {
  const Vec3 p = far_.place;
  return {.code = Code::tolerance_not_reached,
          .args = {rounded_beyond(out_.distance, bound), format_number(bound), std::to_string(far_.triangles),
                   rounded(p.x) + " " + rounded(p.y) + " " + rounded(p.z), std::to_string(out_.mesh.triangles.size())}};
}

Diagnostic Making::takes(double triangles, double least_bytes) const {
  triangles = std::max(triangles, finer_takes_);
  return {.code = Code::limit_tolerance,
          .args = {format_number(options_.tolerance), format_number(std::round(triangles)),
                   format_number(std::ceil(std::max(bytes_for(triangles), least_bytes) / (1 << 20))),
                   std::to_string(run_.max_memory_bytes >> 20)}};
}

// Where memory ends although the mesh was expected to fit, some more than the budget is what it takes.
void Making::expect(double triangles) {
  expected_ = triangles;
  if (options_.tolerance > 0) foresee_memory(takes(triangles, 1.25 * static_cast<double>(run_.max_memory_bytes)));
}

// A grid that is too large says what it takes itself; what the mesh to the tolerance takes is asked for here.
void Making::pass_on(const DiagnosticSink& told) {
  for (const Diagnostic& d : told.diagnostics()) {
    const bool is_grid = d.code == Code::limit_grid_memory && options_.tolerance > 0;
    const double least = is_grid ? parse_number(d.args.at(1)).value_or(0) * (1 << 20) : 0;
    diagnostics_.report(is_grid ? takes(expected_, least) : d);
  }
}

// Before what takes long: seconds at least. Again where it comes to more.
void Making::tell_of(double triangles) {
  constexpr double more = 2;
  const double worth_telling = is_smooth() ? 2e6 : 5e5;
  if (options_.tolerance <= 0 || triangles < std::max(worth_telling, more * told_)) return;
  told_ = triangles;
  std::string samples;
  for (const std::int32_t n : out_.grid.nodes) samples += (samples.empty() ? "" : " x ") + std::to_string(n);
  diagnostics_.report(
      {.code = Code::tolerance_takes,
       .args = {format_number(options_.tolerance), format_number(parse_number(rounded(triangles, 2)).value_or(0)),
                samples, format_number(parse_number(rounded(bytes_for(triangles) / (1 << 20), 2)).value_or(0))}});
}

bool Making::fits(double triangles) {
  expect(triangles);
  return bytes_for(triangles) <= static_cast<double>(run_.max_memory_bytes);
}

bool Making::affords(double triangles) {
  if (fits(triangles)) return true;
  diagnostics_.report(takes(triangles));
  return false;
}

// Before the work begins: how far middles of edges of a coarse mesh are from the surface, at a few of them, tells how
// many triangles a tolerance takes; fewer than it does where thin walls ask for more. Where the surface turns sharply
// between an edge's ends, one vertex may be all that it takes.
bool Making::is_affordable(const Grid& coarse) {
  constexpr std::size_t asked = 200;
  constexpr double unsure = 2, even = 0.8;
  const auto source = counted_on(coarse);
  if (!source) return false;
  TriangleMesh mesh;
  MemoryMeshSink sink(mesh);
  if (!contour(*source, sink, {}, run_, diagnostics_)) return false;
  SurfaceFeet feet(*source, not_stopped());
  std::vector<PointNearSurface> middles;
  std::vector<Vec3> ends, slopes;
  std::vector<double> values, distances;
  const std::size_t step = mesh.triangles.size() / asked + 1;
  for (std::size_t t = 0; t < mesh.triangles.size(); t += step) {
    const Vec3 a = mesh.points[mesh.triangles[t][0]], b = mesh.points[mesh.triangles[t][1]];
    if (planes_of(coarse.box, a) != 0 || planes_of(coarse.box, b) != 0) continue;
    middles.push_back({.point = (a + b) / 2, .most = norm(a - b) / 2});
    ends.push_back(a), ends.push_back(b);
  }
  if (middles.empty()) return true;
  feet.slopes(ends, slopes, values);
  feet.distances(middles, 0.01 * largest_spacing(coarse), distances);
  if (!go_on()) return false;
  double times = 0;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const bool turns = !(dot(slopes[2 * i], slopes[2 * i + 1]) > even * norm(slopes[2 * i]) * norm(slopes[2 * i + 1]));
    times += turns && !is_smooth() ? 1 : parts_for(std::min(distances[i], middles[i].most) / aim());
  }
  const double triangles = times / static_cast<double>(middles.size()) * static_cast<double>(mesh.triangles.size());
  expect(triangles);
  return bytes_for(triangles) <= unsure * static_cast<double>(run_.max_memory_bytes) || affords(triangles);
}

// Some triangles of a mesh, spread over all of it, are looked at: whether they face as the field does there, and how
// far they are.
Making::Look Making::look_at(const TriangleMesh& mesh, double spacing) {
  constexpr std::size_t most = 3000;
  std::vector<Vec3> places, slopes;  // three corners and the middle
  const std::size_t step = mesh.triangles.size() / most + 1;
  for (std::size_t t = 0; t < mesh.triangles.size(); t += step) {
    unsigned planes = ~0U;
    for (const std::uint32_t p : mesh.triangles[t]) planes &= planes_of(out_.grid.box, mesh.points[p]);
    if (planes != 0) continue;
    Vec3 sum;
    for (const std::uint32_t p : mesh.triangles[t]) places.push_back(mesh.points[p]), sum += mesh.points[p];
    places.push_back(sum / 3);
  }
  if (places.empty()) return {};
  std::vector<double> values, distances;
  feet_->slopes(places, slopes, values);
  Look look;
  std::vector<PointNearSurface> middles;
  for (std::size_t t = 0; t < places.size(); t += 4) {
    const Vec3 normal = cross(places[t + 1] - places[t], places[t + 2] - places[t]);
    if (dot(normal, slopes[t + 3]) < 0.5 * norm(normal) * norm(slopes[t + 3]))
      look.astray += 4.0 / static_cast<double>(places.size());
    for (std::size_t side = 0; side < 3; ++side) {
      const std::size_t i = t + side, j = t + (side + 1) % 3;
      middles.push_back({.point = (places[i] + places[j]) / 2,
                         .slope = std::min(norm(slopes[i]), norm(slopes[j])),
                         .most = norm(places[i] - places[j]) / 2});
    }
  }
  feet_->distances(middles, look_near * spacing, distances);
  for (std::size_t t = 0; t < distances.size(); t += 3) {
    const double farthest = std::max({distances[t], distances[t + 1], distances[t + 2]});
    look.triangles_for += std::max(1.0, farthest / options_.tolerance) * static_cast<double>(step);
  }
  const auto nth = distances.end() - 1 - static_cast<std::ptrdiff_t>(few * static_cast<double>(distances.size()));
  std::nth_element(distances.begin(), nth, distances.end());
  look.distance = *nth;
  return look;
}

// A triangle lies in a cell that the surface crosses, but for vertices on sharp edges, which may leave it by as much.
double Making::farthest_on(const Grid& grid) {
  return 2 * norm(Vec3{grid.spacing(0), grid.spacing(1), grid.spacing(2)});
}

// The coarsest of grids on which few triangles go astray and few edges are farther from the surface than
// a quarter of a cell: where a mesh is that close, it turns where the surface turns. Distances in cells go with the
// spacing, which tells how fine the next one must be.
bool Making::resolve(Grid grid) {
  constexpr int most_grids_of_nothing = 4;
  Look before{.astray = 1};
  double spacing_before = HUGE_VAL;
  for (int nothing = 0;;) {
    const double spacing = largest_spacing(grid);
    if (!contour_on(grid)) return false;
    if (out_.mesh.triangles.empty()) {
      if (++nothing == most_grids_of_nothing) break;
      grid = with_spacing(grid.box, spacing / 2);
      continue;
    }
    if (farthest_on(grid) <= options_.tolerance) return go_on();
    const Look look = look_at(out_.mesh, spacing);
    if (!go_on()) return false;
    expect(std::max(grid_triangles_, look.triangles_for));
    tell_of(expected_);
    // What goes astray beside edges of the surface is a share that goes with the spacing; it is refined where it is.
    // What is too thin for the grid is gone on a grid that is finer.
    const bool only_edges = !is_smooth() && look.astray <= 4 * few_astray &&
                            look.astray > before.astray * std::pow(spacing / spacing_before, 1.5);
    const bool follows = look.astray <= few_astray || only_edges;
    before = look, spacing_before = spacing;
    // Where the field has kinks that no grid resolves, a finer one only costs: what it would add, refining adds where
    // it is needed.
    const double triangles = static_cast<double>(out_.mesh.triangles.size()) * (is_smooth() ? 1 : 4);
    if (follows &&
        (look.distance <= std::max(look_near * spacing, options_.tolerance) || triangles > look.triangles_for))
      break;
    const double finer = follows ? std::clamp(look.distance / (look_near * spacing), 1.15, 2.0)
                                 : std::clamp(std::sqrt(look.astray / few_astray), 1.4, 2.0);
    grid = with_spacing(grid.box, spacing / finer);
  }
  if (bytes_for(grid_triangles_) > static_cast<double>(run_.max_memory_bytes)) return affords(expected_);
  measure(std::move(out_.mesh), true, options_.tolerance);
  return go_on();
}

// When little is left, and twice in a row more of it is as far as before, halving makes it worse: two sheets within a
// cell, say, of which the mesh has one. The closest mesh is kept, where memory holds two.
bool Making::gets_no_closer(Stubborn& so_far, std::size_t halved) const {
  constexpr std::size_t little = 20;
  constexpr double as_far = 0.9;
  constexpr int enough = 2;
  const double distance = refinable_->distance();
  const std::size_t far = refinable_->what_is_far(options_.tolerance).triangles,
                    all = refinable_->mesh().triangles.size();
  const bool is_worse = far >= so_far.far && distance >= as_far * so_far.distance && !refinable_->found_creases();
  so_far.rounds = is_worse ? so_far.rounds + 1 : 0;
  so_far.far = far, so_far.distance = distance;
  if (little * halved >= all) return false;
  const bool two_fit = 2 * bytes_for(static_cast<double>(all)) <= static_cast<double>(run_.max_memory_bytes);
  if (two_fit && (!so_far.closest || distance < so_far.closest->distance())) so_far.closest.emplace(*refinable_);
  return so_far.rounds >= enough;
}

Making::Refined Making::refine() {
  constexpr int most_rounds = 24;
  const double aim = this->aim();
  const double longer = std::max(1.0, refinable_->distance() / aim);
  int patience = 4 + static_cast<int>(std::log2(longer) / 2);  // a round takes distances to a quarter
  double left_before = HUGE_VAL;
  std::vector<std::size_t> before;
  Stubborn stubborn;
  for (int round = 0; round < most_rounds; ++round) {
    const double times = std::max(1.0, refinable_->distance() / aim);
    run_.report("refining", longer > 1 ? std::max(0.0, 1 - std::log(times) / std::log(longer)) : 0);
    if (!fits(std::max(refinable_->triangles_for(aim), static_cast<double>(refinable_->mesh().triangles.size()))))
      return Refined::too_large;
    // Not at once: creases are better.
    refinable_->merge(aim);
    refinable_->measure(aim);
    if (round >= 2) refinable_->flip(aim);
    const std::size_t halved = refinable_->refine(aim);
    if (halved == 0 && refinable_->normals_were_right(options_.tolerance)) break;
    refinable_->measure(aim);
    if (!go_on()) return Refined::stopped;
    if (const double left = refinable_->distance(); left > options_.tolerance && left > 0.7 * left_before)
      finer_takes_ = std::max(finer_takes_, triangles_of_finer(left));  // no refining mends that
    left_before = refinable_->distance();
    if (left_before > options_.tolerance && gets_no_closer(stubborn, halved)) break;
    // Where as many edges are halved as before, what is refined is no surface.
    before.push_back(halved);
    // A few creases may be found when all else is done.
    if (refinable_->found_creases() && 1000 * halved < refinable_->mesh().triangles.size())
      patience = std::max(patience, round + 4);
    if (round >= patience && halved >= before[static_cast<std::size_t>(round - 4)]) break;
  }
  if (stubborn.closest && refinable_->distance() > std::max(stubborn.closest->distance(), options_.tolerance))
    refinable_.emplace(std::move(*stubborn.closest));
  return go_on() ? Refined::done : Refined::stopped;
}

bool Making::refine_or_tell() {
  tell_of(std::max(refinable_->triangles_for(aim()), grid_triangles_));
  const Refined refined = refine();
  if (refined == Refined::too_large) diagnostics_.report(takes(expected_));
  return refined == Refined::done;
}

bool Making::to_tolerance(const Grid& first) {
  const Vec3 size = first.box.max - first.box.min;
  const double longest = std::max({size.x, size.y, size.z});
  // No coarser than what a feature takes to be seen, nor so coarse that a plain shape is lost.
  const double spacing =
      options_.smallest_feature > 0 ? std::min(options_.smallest_feature, longest / 16) : longest / 32;
  if (!is_affordable(with_spacing(first.box, longest / 16))) return false;
  if (!resolve(with_spacing(first.box, spacing))) return false;
  if (!refinable_) {
    out_.distance = farthest_on(out_.grid);
    return true;
  }
  if (!refine_or_tell() || !take_refined() || (spares_ && !thin())) return false;
  if (out_.distance > options_.tolerance) left_ = not_reached(options_.tolerance);
  return true;
}

// Where the grid has made a hole through a wall, or a bridge between two, no refining mends that: what is thicker than
// twice the tolerance has to be seen by the grid. The closest of all meshes is taken. What is missed then is little, so
// it is not worth any memory and time.
bool Making::take_refined() {
  constexpr int most_attempts = 5;
  constexpr double least_finer = 1.3, little_finer = 1.5, much_closer = 0.7, little_missing = 1.5;
  constexpr double few_triangles = 5e5;
  constexpr double most_spare = 3, least_spared = 5e4;  // fewer are not worth the time
  constexpr double bytes_to_thin = 500;
  AccurateMesh best;
  bool lacks_memory = false;
  std::size_t far_before = 0;
  double distance_before = 0, spacing_before = 0;
  for (int attempt = 1;; ++attempt) {
    const double distance = refinable_->distance();
    const auto triangles = static_cast<double>(refinable_->mesh().triangles.size());
    const RefinableMesh::Far far = refinable_->what_is_far(options_.tolerance);
    const bool is_fine = triangles > most_spare * refinable_->triangles_for_curves(options_.tolerance);
    if (attempt == 1 || distance <= options_.tolerance || distance < much_closer * best.distance) {
      const bool fits = triangles * bytes_to_thin <= static_cast<double>(run_.max_memory_bytes);
      far_ = far;
      spares_ = !is_smooth() && triangles > least_spared && is_fine && fits;
      best = {.mesh = refinable_->take(), .grid = out_.grid, .euler = out_.euler, .distance = distance};
    }
    if (best.distance <= options_.tolerance) break;
    finer_takes_ = std::max(triangles_of_finer(distance), std::min(triangles, most_triangles));
    expect(finer_takes_);
    lacks_memory = lacks_memory || bytes_for(finer_takes_) > static_cast<double>(run_.max_memory_bytes);
    // Of holes and bridges, a finer grid leaves none or few; as many are something else.
    const double spacing = largest_spacing(best.grid);
    const auto comes_there = [&] {  // if distances go on with the spacing as they did
      const double order = std::log(distance_before / distance) / std::log(spacing_before / spacing);
      return triangles * std::pow(distance / options_.tolerance, 2 / std::max(order, 0.1)) < most_triangles;
    };
    const bool helps = attempt == 1 || triangles < few_triangles || distance < little_missing * options_.tolerance ||
                       far.triangles < far_before / 2 || (distance < much_closer * distance_before && comes_there());
    far_before = far.triangles, distance_before = distance, spacing_before = spacing;
    if (attempt == most_attempts || !helps) break;
    const double affordable =
        std::min(most_triangles, static_cast<double>(run_.max_memory_bytes) / RefinableMesh::bytes_per_triangle / 2);
    const double finer = std::min(triangles < few_triangles ? finer_for(distance, most_finer) : little_finer,
                                  std::sqrt(affordable / triangles));
    if (!(finer >= least_finer)) break;
    if (!contour_on(with_spacing(out_.grid.box, largest_spacing(out_.grid) / finer))) return false;
    measure(std::move(out_.mesh), true, options_.tolerance);
    if (!go_on() || !refine_or_tell()) return false;
  }
  out_ = std::move(best);
  if (out_.distance <= options_.tolerance || !lacks_memory) return true;
  diagnostics_.report(takes(expected_));
  return false;
}

// Where walls, not curves, ask for the grid, most of its triangles are spare: they are taken away as far as some of the
// tolerance goes, and what that leaves too far is refined. Around places where refining does not mend it, all are kept
// the next time.
bool Making::thin() {
  constexpr int most_attempts = 3;
  constexpr double share = 0.6, least_gain = 0.8;
  AccurateMesh whole = std::move(out_);
  std::vector<char> kept = beside_wedges(whole.mesh);
  // As many as before were too far, with all kept around them: this is not about what was taken away.
  std::size_t far_before = whole.distance > options_.tolerance ? 2 * far_.triangles : SIZE_MAX;
  for (int attempt = 0; attempt < most_attempts; ++attempt) {
    out_ = {.mesh = whole.mesh, .grid = whole.grid, .euler = whole.euler};
    refinable_.reset();
    run_.report("simplifying", static_cast<double>(attempt) / most_attempts);
    if (!simplify_mesh(out_.mesh, out_.grid.box, share * options_.tolerance, run_, kept)) return go_on();
    measure(std::move(out_.mesh), false, options_.tolerance);
    if (!go_on()) return false;
    const Refined refined = refine();
    if (refined == Refined::stopped) return false;
    if (refined == Refined::too_large) break;
    out_.distance = refinable_->distance();
    if (static_cast<double>(refinable_->mesh().triangles.size()) >
        least_gain * static_cast<double>(whole.mesh.triangles.size()))
      break;
    if (out_.distance <= std::max(options_.tolerance, whole.distance)) {
      far_ = refinable_->what_is_far(options_.tolerance);
      out_.mesh = refinable_->take();
      return true;
    }
    const std::size_t far = refinable_->what_is_far(options_.tolerance).triangles;
    if (far >= far_before / 2) break;
    far_before = far;
    refinable_->mark_around_far(options_.tolerance, feet_->cell(), whole.mesh.points, kept);
  }
  out_ = std::move(whole);
  return true;
}

// What is left goes with the spacing: how much finer the next grid is.
double Making::finer_for(double distance, double most) const {
  constexpr double usual = 1.7;
  return std::clamp(1.2 * distance / options_.tolerance, usual, most);
}

// Triangles go with the square of the spacing. Of some fields the next grid is all that it takes, of others what is
// left goes on as it began: between the two. Told once, by the first grid: of those that memory made too coarse, no
// more can be told.
double Making::triangles_of_finer(double distance) const {
  if (finer_takes_ > 0) return std::max(finer_takes_, 1.2 * grid_triangles_);
  const double next = finer_for(distance, most_finer), all = std::min(1.5 * next, finer_for(distance, HUGE_VAL));
  return std::sqrt(std::min(grid_triangles_ * next * next, most_triangles) *
                   std::min(grid_triangles_ * all * all, most_triangles));
}

// What the planes of triangles promise is measured. Where it does not hold at a few places, all is kept around these
// the next time; else, or where that has not helped, it is tried from the start with less. The closest mesh is taken.
// One that is too far before anything is taken away comes no closer by that.
bool Making::simplify() {
  constexpr int most_attempts = 6, most_of_full = 3;
  constexpr std::size_t few_of = 50;
  const TriangleMesh whole = std::move(out_.mesh);
  const auto distance_of = [&](const TriangleMesh& mesh) {
    measure(mesh, false, options_.simplify);
    refinable_->measure_creases(options_.simplify);
    return refinable_->distance();
  };
  std::vector<char> kept(whole.points.size(), 0);
  const auto keep_around_few = [&] {
    far_ = refinable_->what_is_far(options_.simplify);
    if (far_.triangles >= refinable_->mesh().triangles.size() / few_of) return false;
    refinable_->mark_around_far(options_.simplify, feet_->cell(), whole.points, kept);
    return true;
  };
  double bound = options_.simplify, before = 0;
  out_.distance = HUGE_VAL;
  RefinableMesh::Far far_of_closest;
  for (int attempt = 0; attempt < most_attempts; ++attempt) {
    run_.report("simplifying", static_cast<double>(attempt) / most_attempts);
    TriangleMesh mesh = whole;
    if (!simplify_mesh(mesh, out_.grid.box, bound, run_, kept)) return go_on();
    const double distance = distance_of(mesh);
    if (!go_on()) return false;
    const bool is_few = keep_around_few();
    if (distance < out_.distance) {
      out_.distance = distance;
      far_of_closest = far_;
      out_.mesh = refinable_->take();
    }
    if (distance <= std::max(options_.simplify, before)) break;
    if (attempt == 0 && (before = distance_of(whole)) > options_.simplify) {
      if (options_.tolerance == 0 || !keep_around_few()) break;
    } else if (!is_few || attempt + 1 >= most_of_full) {
      bound *= std::clamp(0.95 * options_.simplify / distance, 0.2, 0.6);
    }
  }
  far_ = far_of_closest;
  if (!go_on()) return false;
  if (out_.distance <= options_.simplify) return true;
  const bool is_grid = before > options_.simplify && options_.tolerance == 0;
  left_ = is_grid ? Diagnostic{.code = Code::simplify_from_coarse,
                               .args = {rounded_beyond(before, options_.simplify), format_number(options_.simplify)}}
                  : not_reached(options_.simplify);
  return true;
}

// Takes what was measured again, unless that is too far: there, all is to be kept the next time.
bool Making::takes_over(double bound, std::vector<char>& kept) {
  const bool is_near = refinable_->distance() <= std::max(bound, out_.distance);
  if (is_near) {
    out_.mesh = refinable_->mesh();
    out_.distance = std::max(out_.distance, refinable_->distance());
  } else {
    refinable_->mark_around_far(bound, feet_->cell(), out_.mesh.points, kept);
  }
  kept.resize(out_.mesh.points.size(), 0);
  return is_near;
}

void Making::measure_marked(TriangleMesh mesh, std::span<const char> marked, double bound) {
  refinable_.emplace(std::move(mesh), out_.grid.box, *feet_, false, marked);
  refinable_->take_as_known(marked);
  refinable_->measure_points(bound);
  refinable_->measure(bound);
}

// Where walls end beside each other. Where no change within the tolerance takes a few triangles apart, they are halved
// for it: that is kept if fewer are left then.
bool Making::untangle() {
  constexpr int most_attempts = 4, most_rounds = 8;
  constexpr std::size_t few_left = 100;
  const double bound = options_.simplify > 0 ? options_.simplify : options_.tolerance;
  std::vector<char> kept(out_.mesh.points.size(), 0);
  const auto has_any = [](const std::vector<char>& marks) { return std::ranges::count(marks, 1) > 0; };
  TriangleMesh fewest = out_.mesh;
  std::size_t left = SIZE_MAX;
  for (int attempt = 0; attempt < most_attempts; ++attempt) {
    run_.report("untangling", static_cast<double>(attempt) / most_attempts);
    refinable_.reset();
    TriangleMesh mesh = out_.mesh;
    Untangled marks = untangle_mesh(mesh, out_.grid.box, *feet_, bound, kept, run_);
    if (!go_on()) return false;
    if (has_any(marks.changed)) {
      measure_marked(std::move(mesh), marks.changed, bound);
      refinable_->measure_creases(bound);
      if (!takes_over(bound, kept)) continue;
    }
    if (marks.left >= left) break;
    fewest = out_.mesh;
    left = marks.left;
    for (std::size_t p = 0; p < marks.stuck.size(); ++p)
      if (kept[p] != 0) marks.stuck[p] = 0;
    if (!has_any(marks.stuck) || left > few_left || attempt + 1 == most_attempts) break;
    measure_marked(out_.mesh, marks.stuck, bound);
    refinable_->take_as_far(marks.stuck, bound);
    for (int round = 0; round < most_rounds && refinable_->refine(bound) > 0; ++round) {
      refinable_->measure(bound);
      refinable_->merge(bound);
      refinable_->measure(bound);
      refinable_->flip(bound);
    }
    if (!go_on()) return false;
    (void)takes_over(bound, kept);
  }
  out_.mesh = std::move(fewest);
  drop_unused_points(out_.mesh);
  return true;
}

std::optional<AccurateMesh> Making::make(Grid grid) {
  if (options_.tolerance > 0) {
    if (!to_tolerance(grid)) return std::nullopt;
  } else {
    if (!contour_on(grid)) return std::nullopt;
  }
  if (options_.simplify > 0 && !out_.mesh.triangles.empty() && !simplify()) return std::nullopt;
  if (!out_.mesh.triangles.empty() && !untangle()) return std::nullopt;
  if (left_) diagnostics_.report(*left_);
  forget_foreseen_memory();
  out_.grid_samples = counts_.on_grids;
  out_.surface_samples = counts_.at_points;
  return std::move(out_);
}

}  // namespace

std::optional<AccurateMesh> make_accurate_mesh(const SourceOn& source_on, const Grid& grid,
                                               const AccurateMeshOptions& options, const RunOptions& run,
                                               DiagnosticSink& diagnostics) {
  return Making(source_on, options, run, diagnostics).make(grid);
}

}  // namespace meso::implicit
