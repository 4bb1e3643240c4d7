// SPDX-License-Identifier: Apache-2.0
#include "lattice/cell_solid.hpp"

#include <BOPAlgo_PaveFiller.hxx>
#include <set>

#include "face_moments.hpp"
#include "lattice/jointed_box.hpp"
#include "lattice/jointed_cell.hpp"
#include "lattice/primitive_field.hpp"
#include "point_within.hpp"
#include "stop_watch.hpp"

namespace meso::brep {
namespace {

constexpr std::size_t points_an_edge = 5;
constexpr std::size_t points_a_face = 8;  ///< squared

bool on_wall(double value, double low, double high, double tolerance) {
  return std::fabs(value - low) < tolerance || std::fabs(value - high) < tolerance;
}

/// Where a coordinate was written to few digits (3.333333 in a box of 10/3) and was meant to be on a wall, it is put
/// there: a ball and its copy from the next cell must be one, not two that differ by 1e-7.
Vec3 on_near_walls(Vec3 p, const Box3& box, double tolerance) {
  for (std::size_t i = 0; i < 3; ++i)
    for (const double wall : {box.min[i], box.max[i]})
      if (std::fabs(p[i] - wall) < tolerance) p[i] = wall;
  return p;
}

CellPrimitive on_near_walls(const CellPrimitive& primitive, const Box3& box, double tolerance) {
  const auto moved = [&](Vec3 p) { return on_near_walls(p, box, tolerance); };
  if (const Ball* ball = std::get_if<Ball>(&primitive)) return Ball{moved(ball->centre), ball->radius};
  const auto& strut = std::get<Frustum>(primitive);
  return Frustum{moved(strut.start), moved(strut.end), strut.start_radius, strut.end_radius};
}

/// The direction in which the thickest strut leaves a ball that no wall cuts.
std::optional<Vec3> strut_of(const Ball& ball, const CellShape& cell) {
  for (std::size_t i = 0; i < 3; ++i)
    if (ball.centre[i] - ball.radius <= cell.box.min[i] || ball.centre[i] + ball.radius >= cell.box.max[i]) return {};
  std::optional<Vec3> best;
  double thickest = 0;
  for (const CellPrimitive& primitive : cell.primitives) {
    const auto* strut = std::get_if<Frustum>(&primitive);
    if (strut == nullptr) continue;
    for (const bool at_end : {false, true}) {
      const Vec3 away = at_end ? strut->start - strut->end : strut->end - strut->start;
      const double radius = at_end ? strut->end_radius : strut->start_radius;
      if (norm((at_end ? strut->end : strut->start) - ball.centre) > cell.tolerance() || radius <= thickest) continue;
      best = away / norm(away);
      thickest = radius;
    }
  }
  return best;
}

/// The seam goes where the box walls cut the ball anyway: fewer edges, and pieces that can be joined again.
TopoDS_Shape to_solid(const Ball& ball, const CellShape& cell) {
  const double tolerance = cell.tolerance();
  const bool cut_by_x = on_wall(ball.centre.x, cell.box.min.x, cell.box.max.x, tolerance);
  const bool cut_by_y = on_wall(ball.centre.y, cell.box.min.y, cell.box.max.y, tolerance);
  const gp_Dir seam = cut_by_x && !cut_by_y ? gp::DY() : gp::DX();
  return BRepPrimAPI_MakeSphere(gp_Ax2(to_pnt(ball.centre), gp::DZ(), seam), ball.radius).Solid();
}

/// A round end of a strut, no more: other struts hide it but at the rim of the lattice, and where its poles are does
/// not matter. Turned, it touches the strut in its equator, and OpenCASCADE may intersect what boxes leave of it for
/// hours.
bool is_end_of_strut(const Ball& ball, const CellShape& cell) {
  return std::ranges::any_of(cell.primitives, [&](const CellPrimitive& primitive) {
    const auto* strut = std::get_if<Frustum>(&primitive);
    if (strut == nullptr) return false;
    const auto ends_it = [&](Vec3 end, double radius) {
      return norm(end - ball.centre) <= cell.tolerance() && std::fabs(radius - ball.radius) <= cell.tolerance();
    };
    return ends_it(strut->start, strut->start_radius) || ends_it(strut->end, strut->end_radius);
  });
}

/// Lines that a body cuts into a ball are followed only up to a pole beside them. What two walls or three leave of a
/// ball can do without poles and seam, which go to the other side; where no wall cuts it, a pole is hidden in a strut.
std::optional<TopoDS_Shape> with_poles_aside(const Ball& ball, const CellShape& cell) {
  if (const auto strut = strut_of(ball, cell))
    return BRepPrimAPI_MakeSphere(gp_Ax2(to_pnt(ball.centre), to_dir(*strut)), ball.radius).Solid();
  Vec3 inwards;
  std::vector<std::size_t> cuts;
  for (std::size_t i = 0; i < 3; ++i)
    if (on_wall(ball.centre[i], cell.box.min[i], cell.box.max[i], cell.tolerance())) {
      inwards[i] = ball.centre[i] < (cell.box.min[i] + cell.box.max[i]) / 2 ? 1 : -1;
      cuts.push_back(i);
    }
  if (cuts.size() < 2) return {};
  Vec3 pole;
  pole[cuts[0]] = inwards[cuts[0]];
  pole[cuts[1]] = -inwards[cuts[1]];
  return BRepPrimAPI_MakeSphere(gp_Ax2(to_pnt(ball.centre), to_dir(pole), to_dir(-inwards)), ball.radius).Solid();
}

/// Struts of neighbouring cells must be split alike, so direction and seam depend on the line, not on how it is
/// written.
TopoDS_Shape to_solid(Frustum frustum, const CellShape&) {
  const auto is_negative = [](Vec3 d, double eps) {
    for (std::size_t i = 0; i < 3; ++i)
      if (std::fabs(d[i]) > eps) return d[i] < 0;
    return false;
  };
  const double length = norm(frustum.end - frustum.start);
  if (is_negative(frustum.end - frustum.start, 1e-9 * length)) {
    std::swap(frustum.start, frustum.end);
    std::swap(frustum.start_radius, frustum.end_radius);
  }
  const Vec3 axis = (frustum.end - frustum.start) / length;
  Vec3 seam{};  // in the plane of a box wall where the strut is parallel to one
  for (std::size_t i = 0; i < 3 && norm(seam) < 0.5; ++i) {
    Vec3 wall_normal{};
    wall_normal[i] = 1;
    if (std::fabs(axis[i]) < 1e-9) seam = cross(axis, wall_normal);
  }
  const gp_Ax2 frame = norm(seam) < 0.5 ? gp_Ax2(to_pnt(frustum.start), to_dir(axis))
                                        : gp_Ax2(to_pnt(frustum.start), to_dir(axis), to_dir(seam));
  if (std::fabs(frustum.start_radius - frustum.end_radius) < 1e-9 * length)
    return BRepPrimAPI_MakeCylinder(frame, frustum.start_radius, length).Solid();
  return BRepPrimAPI_MakeCone(frame, frustum.start_radius, frustum.end_radius, length).Solid();
}

bool usable(const Ball& ball, double tolerance) { return std::isfinite(norm(ball.centre)) && ball.radius > tolerance; }
bool usable(const Frustum& frustum, double tolerance) {
  return std::isfinite(norm(frustum.start)) && norm(frustum.end - frustum.start) > tolerance &&
         std::isfinite(norm(frustum.end)) && frustum.start_radius >= 0 && frustum.end_radius >= 0 &&
         std::isfinite(frustum.start_radius) && std::isfinite(frustum.end_radius) &&
         std::fmax(frustum.start_radius, frustum.end_radius) > tolerance;
}

/// Struts that taper: two alike that start from one point meet in plane curves with a corner, and OpenCASCADE, at its
/// least tolerance, follows an edge there that it has not made.
bool tapers(const CellPrimitive& primitive) {
  const Frustum* strut = std::get_if<Frustum>(&primitive);
  return strut != nullptr && strut->start_radius != strut->end_radius;
}

TopoDS_Shape fused(const std::vector<TopoDS_Shape>& solids, double fuzzy, const RunOptions& run) {
  const Handle(StopWatch) watch = new StopWatch(run);
  if (solids.size() == 1) return solids.front();
  TopTools_ListOfShape first, rest;
  for (const TopoDS_Shape& solid : solids) (first.IsEmpty() ? first : rest).Append(solid);
  BRepAlgoAPI_Fuse fuse;
  fuse.SetArguments(first);
  fuse.SetTools(rest);
  fuse.SetNonDestructive(true);
  fuse.SetRunParallel(true);
  fuse.SetFuzzyValue(fuzzy);
  fuse.Build(watch->Start());
  return fuse.HasErrors() ? TopoDS_Shape() : fuse.Shape();
}

bool contradicts(double a, double b, double scale, double tolerance) {
  return !(std::fabs(a - b) <= tolerance * scale);
}

/// Good to about 1e-9: these volumes are compared, not reported.
double volume_of(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties);
  return properties.Mass();
}

/// Common and Cut from one intersection: what is inside and what is outside must add up to what was there.
std::optional<TopoDS_Shape> cut_to_box(const TopoDS_Shape& whole, const CellShape& cell, double fuzzy,
                                       const RunOptions& run) {
  const Handle(StopWatch) watch = new StopWatch(run);
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(to_pnt(cell.box.min), to_pnt(cell.box.max)).Solid();
  TopTools_ListOfShape arguments, wholes, boxes;
  wholes.Append(whole);
  boxes.Append(box);
  arguments.Append(whole);
  arguments.Append(box);
  BOPAlgo_PaveFiller filler;
  filler.SetArguments(arguments);
  filler.SetNonDestructive(true);
  filler.SetRunParallel(true);
  filler.SetFuzzyValue(fuzzy);
  filler.Perform(watch->Start());
  if (filler.HasErrors()) return {};
  BRepAlgoAPI_Common common(whole, box, filler);
  BRepAlgoAPI_Cut cut(whole, box, filler);
  if (common.HasErrors() || cut.HasErrors()) return {};
  const double before = volume_of(whole), inside = volume_of(common.Shape()), outside = volume_of(cut.Shape());
  if (contradicts(inside + outside, before, before, 1e-6)) return {};
  // Where a wall runs through a ball's centre but for 1e-7 of the cell, nothing is divided and all sums hold.
  const auto reaches = [&](const TopoDS_Shape& piece, auto within) {
    return std::ranges::any_of(points_along_edges(piece, points_an_edge), within) ||
           std::ranges::any_of(points_on_faces(piece, points_a_face), within);
  };
  const auto depth = [&](Vec3 p) {
    double least = HUGE_VAL;
    for (std::size_t i = 0; i < 3; ++i) least = std::min({least, p[i] - cell.box.min[i], cell.box.max[i] - p[i]});
    return least;
  };
  if (reaches(cut.Shape(), [&](Vec3 p) { return depth(p) > cell.tolerance(); }) ||
      reaches(common.Shape(), [&](Vec3 p) { return depth(p) < -cell.tolerance(); }))
    return {};
  TopoDS_Shape clipped = common.Shape();
  BRepTools::RemoveInternals(clipped);  // points where a ball touches a wall bound nothing
  return clipped;
}

/// Every corner and edge middle of a right result lies on the surface of the union, or within it on a wall.
bool on_union(const TopoDS_Shape& solid, const std::vector<CellPrimitive>& primitives, const Box3& box,
              double tolerance) {
  const auto agrees = [&](Vec3 p) {
    const double distance = signed_distance(primitives, p);
    bool wall = false;
    for (std::size_t i = 0; i < 3; ++i) wall = wall || on_wall(p[i], box.min[i], box.max[i], tolerance);
    return wall ? distance < tolerance : std::fabs(distance) < tolerance;
  };
  for (TopExp_Explorer it(solid, TopAbs_EDGE); it.More(); it.Next()) {
    const TopoDS_Edge edge = TopoDS::Edge(it.Current());
    if (BRep_Tool::Degenerated(edge)) continue;
    const BRepAdaptor_Curve curve(edge);
    for (const double at : {0.0, 0.5, 1.0})
      if (!agrees(to_vec(curve.Value((1 - at) * curve.FirstParameter() + at * curve.LastParameter())))) return false;
  }
  return true;
}

std::vector<Box3> boxes_of(const CellShape& cell) {
  std::vector<Box3> boxes;
  for (const CellPrimitive& primitive : cell.primitives) boxes.push_back(bounds(primitive));
  if (!cell.primitives.empty()) return boxes;
  for (const TopoDS_Shape& solid : cell.solids) {
    Box3& box = boxes.emplace_back();
    for (TopExp_Explorer it(solid, TopAbs_FACE); it.More(); it.Next()) {
      const Box3 face = face_box(TopoDS::Face(it.Current()));
      box.extend(face.min);
      box.extend(face.max);
    }
  }
  return boxes;
}

/// The balls that a strut of the neighbour has beside it: beyond the pattern's rim little but balls reaches out.
std::vector<CellPrimitive> balls_of(const CellShape& cell, const Index3& shift, const CellPrimitive& strut) {
  std::vector<CellPrimitive> balls;
  if (std::holds_alternative<Ball>(strut) || shift == Index3{}) return balls;
  const Vec3 size = cell.size();
  for (const CellPrimitive& primitive : cell.primitives)
    if (std::holds_alternative<Ball>(primitive))
      balls.push_back(translated(primitive, {shift[0] * size.x, shift[1] * size.y, shift[2] * size.z}));
  return balls;
}

}  // namespace

std::optional<CellShape> cell_shape(const LatticeCell& cell, DiagnosticSink& sink) {
  CellShape shape{.box = cell.box, .solids = {}, .primitives = {}};
  for (const CellPrimitive& primitive : cell.primitives)
    shape.primitives.push_back(on_near_walls(primitive, cell.box, shape.tolerance()));
  try {
    for (const CellPrimitive& primitive : shape.primitives) {
      if (!std::visit([&](const auto& p) { return usable(p, shape.tolerance()); }, primitive)) {
        sink.report({.code = Code::geometry_not_repeatable, .args = {"a ball or strut without extent"}});
        return {};
      }
      shape.solids.push_back(std::visit([&](const auto& p) { return to_solid(p, shape); }, primitive));
    }
  } catch (const Standard_Failure& failure) {
    sink.report({.code = Code::geometry_not_repeatable, .args = {what(failure)}});
    return {};
  }
  return shape;
}

std::optional<CellShape> with_poles_aside(const CellShape& cell) {
  if (cell.varied) return {};
  CellShape out = cell;
  bool has_changed = false;
  try {
    for (std::size_t i = 0; i < cell.primitives.size(); ++i)
      if (const auto* ball = std::get_if<Ball>(&cell.primitives[i]); ball != nullptr && !is_end_of_strut(*ball, cell))
        if (auto solid = with_poles_aside(*ball, cell)) {
          out.solids[i] = std::move(*solid);
          has_changed = true;
        }
  } catch (const Standard_Failure&) {
    return {};
  }
  if (!has_changed) return {};
  return out;
}

std::vector<std::uint32_t> Reach::parts_with(bool itself, std::uint64_t present) const {
  std::set<std::uint32_t> all;
  if (itself) all.insert(own.begin(), own.end());
  const std::vector<Neighbour>& others = itself ? neighbours : rim;
  for (std::size_t n = 0; n < others.size(); ++n)
    if (present >> n & 1) all.insert(others[n].parts.begin(), others[n].parts.end());
  return {all.begin(), all.end()};
}

Reach reach_of(const CellShape& cell) {
  const Vec3 size = cell.size();
  const double tolerance = cell.tolerance();
  const std::vector<Box3> boxes = boxes_of(cell);
  Box3 all;
  for (const Box3& box : boxes) {
    all.extend(box.min);
    all.extend(box.max);
  }
  Reach reach;
  std::vector<CellPrimitive> placed;  // parallel to reach.parts, for beams
  const auto add_from = [&](const Index3& shift, bool to_own, std::vector<std::uint32_t>& into) {
    for (std::size_t s = 0; s < cell.solids.size(); ++s) {
      const Vec3 by{shift[0] * size.x, shift[1] * size.y, shift[2] * size.z};
      bool reaches = true;
      for (std::size_t i = 0; i < 3; ++i)
        reaches = reaches && boxes[s].min[i] + by[i] < cell.box.max[i] - tolerance &&
                  boxes[s].max[i] + by[i] > cell.box.min[i] + tolerance;
      if (!reaches) continue;
      if (cell.primitives.empty()) {
        const auto known = std::ranges::find_if(
            reach.parts, [&](const Reach::Part& part) { return part.solid == s && part.shift == shift; });
        into.push_back(static_cast<std::uint32_t>(known - reach.parts.begin()));
        if (known == reach.parts.end()) reach.parts.push_back({s, shift});
        continue;
      }
      const CellPrimitive primitive = translated(cell.primitives[s], by);
      if (covered(primitive, to_own ? cell.primitives : balls_of(cell, shift, primitive), cell.box)) continue;
      const auto known = std::find_if(placed.begin(), placed.end(),
                                      [&](const CellPrimitive& other) { return same(primitive, other, tolerance); });
      into.push_back(static_cast<std::uint32_t>(known - placed.begin()));
      if (known != placed.end()) continue;
      placed.push_back(primitive);
      reach.parts.push_back({s, shift});
    }
  };
  add_from({}, false, reach.own);
  if (cell.cut_to_box) return reach;
  Index3 low{}, high{};  // shifts under which anything can reach the box
  for (std::size_t i = 0; i < 3; ++i) {
    low[i] = static_cast<std::int32_t>(std::ceil((cell.box.min[i] - all.max[i] + tolerance) / size[i]));
    high[i] = static_cast<std::int32_t>(std::floor((cell.box.max[i] - all.min[i] - tolerance) / size[i]));
  }
  for (std::int32_t x = low[0]; x <= high[0]; ++x)
    for (std::int32_t y = low[1]; y <= high[1]; ++y)
      for (std::int32_t z = low[2]; z <= high[2]; ++z) {
        Reach::Neighbour neighbour{.shift = {x, y, z}, .parts = {}};
        if (neighbour.shift == Index3{}) continue;
        add_from(neighbour.shift, true, neighbour.parts);
        if (!neighbour.parts.empty()) reach.neighbours.push_back(neighbour);
        neighbour.parts.clear();
        add_from(neighbour.shift, false, neighbour.parts);
        if (!neighbour.parts.empty()) reach.rim.push_back(neighbour);
      }
  return reach;
}

namespace {

/// In another ball: where struts of several radii end, OpenCASCADE is asked for the largest ball only. Balls about one
/// centre have nothing in common, and struts that end on the lesser of them have crashed its intersection.
bool is_within(const CellPrimitive& primitive, const std::vector<CellPrimitive>& others) {
  const Ball* ball = std::get_if<Ball>(&primitive);
  return ball != nullptr && std::ranges::any_of(others, [&](const CellPrimitive& other) {
           const Ball* larger = std::get_if<Ball>(&other);
           return larger != nullptr && larger->radius > ball->radius &&
                  norm(larger->centre - ball->centre) + ball->radius <= larger->radius;
         });
}

Vec3 shift_of(const Reach::Part& part, const CellShape& cell) {
  const Vec3 size = cell.size();
  return {part.shift[0] * size.x, part.shift[1] * size.y, part.shift[2] * size.z};
}

/// None where the solids are not beams.
std::vector<CellPrimitive> primitives_in_box(const CellShape& cell, const Reach& reach,
                                             const std::vector<std::uint32_t>& parts) {
  std::vector<CellPrimitive> out;
  for (const std::uint32_t index : parts)
    if (!cell.primitives.empty())
      out.push_back(translated(cell.primitives[reach.parts[index].solid], shift_of(reach.parts[index], cell)));
  return out;
}

/// Faces that close have no area as a vector, and enclose the same volume seen from any direction.
bool is_sound(const TopoDS_Shape& solid, const std::vector<CellPrimitive>& primitives, const CellShape& cell) {
  FaceMoments sum;
  for (TopExp_Explorer it(solid, TopAbs_FACE); it.More(); it.Next()) {
    const FaceMoments m = face_moments(TopoDS::Face(it.Current()));
    sum.vector_area += m.vector_area;
    sum.volume_moment += m.volume_moment;
  }
  const Vec3 size = cell.size();
  const double box = size.x * size.y * size.z, volume = sum.volume_moment.x;
  if (contradicts(norm(sum.vector_area), 0, norm(size) * norm(size), 1e-6) ||
      contradicts(sum.volume_moment.y, volume, box, 1e-6) || contradicts(sum.volume_moment.z, volume, box, 1e-6))
    return false;
  return !contradicts(volume, sampled_volume(primitives, cell.box, 5), box, 1e-2) &&
         on_union(solid, primitives, cell.box, cell.tolerance());
}

/// Without a boolean, where struts part on the balls of their nodes.
std::optional<TopoDS_Shape> put_together(const std::vector<CellPrimitive>& primitives, const CellShape& cell,
                                         int variant) {
  try {
    std::string why;
    auto inside = jointed_cell(primitives, cell.box, cell.tolerance(), variant, why);
    if (!inside || inside->IsNull() || is_sound(*inside, primitives, cell)) return inside;
  } catch (const Standard_Failure&) {
  }
  return {};
}

/// The union of `solids`, cut to the box; of `primitives`, if these are known. Else `fault` says what is wrong.
std::optional<TopoDS_Shape> fused_in_box(const std::vector<TopoDS_Shape>& solids,
                                         const std::vector<CellPrimitive>& primitives, const CellShape& cell,
                                         double fuzzy, const RunOptions& run, const char*& fault) {
  try {
    const TopoDS_Shape whole = fused(solids, fuzzy, run);
    std::optional<TopoDS_Shape> inside;
    for (const double wider : {0.0, cell.tolerance() / 2})
      if (!inside && !whole.IsNull()) inside = cut_to_box(whole, cell, wider, run);
    fault = "the unit cell cannot be cut to its box";
    if (!inside || primitives.empty()) return inside;
    const Vec3 size = cell.size();
    fault = "the fused unit cell is not the union of its balls and struts";
    if (!on_union(*inside, primitives, cell.box, cell.tolerance()) ||
        contradicts(volume_of(*inside), sampled_volume(primitives, cell.box, 7), size.x * size.y * size.z, 2e-3))
      return {};
    return inside;
  } catch (const Standard_Failure&) {
    fault = "the unit cell cannot be fused";
    return {};
  }
}

}  // namespace

std::optional<TopoDS_Shape> solid_in_box(const CellShape& cell, const Reach& reach,
                                         const std::vector<std::uint32_t>& parts, const RunOptions& run,
                                         DiagnosticSink& sink, FusedBudget* budget) {
  std::vector<TopoDS_Shape> solids;
  const std::vector<CellPrimitive> primitives = primitives_in_box(cell, reach, parts);
  for (std::size_t n = 0; n < parts.size(); ++n) {
    if (!primitives.empty() && is_within(primitives[n], primitives)) continue;
    const Reach::Part& part = reach.parts[parts[n]];
    gp_Trsf move;
    const Vec3 by = shift_of(part, cell);
    move.SetTranslation(gp_Vec(by.x, by.y, by.z));
    solids.push_back(cell.solids[part.solid].Moved(TopLoc_Location(move)));
  }
  if (solids.empty()) return TopoDS_Shape();
  if (cell.varied) {
    if (auto inside = put_together(primitives, cell, 0)) return inside;
    if (budget != nullptr && !budget->take()) return {};
  }
  // Surfaces that nearly coincide, or nearly meet in one curve, intersect at one tolerance and not at another.
  const double least = std::ranges::any_of(primitives, tapers) ? cell.tolerance() / 4 : 0;
  const char* fault = nullptr;
  for (const double fuzzy : {least, cell.tolerance() / 2})
    if (auto inside = fused_in_box(solids, primitives, cell, fuzzy, run, fault)) return inside;
  if (!run.should_stop()) sink.report({.code = Code::geometry_not_repeatable, .args = {fault}});
  return {};
}

bool is_put_together(const CellShape& cell, const Reach& reach, const std::vector<std::uint32_t>& parts) {
  std::string why;
  return parts.empty() ||
         (cell.varied && jointed_box(primitives_in_box(cell, reach, parts), cell.box, cell.tolerance(), why));
}

TopoDS_Shape solid_in_box_otherwise(const CellShape& cell, const Reach& reach, const std::vector<std::uint32_t>& parts,
                                    int variant) {
  if (!cell.varied || parts.empty()) return {};
  return put_together(primitives_in_box(cell, reach, parts), cell, variant).value_or(TopoDS_Shape());
}

}  // namespace meso::brep
