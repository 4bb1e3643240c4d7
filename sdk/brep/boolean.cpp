// SPDX-License-Identifier: Apache-2.0
#include "boolean.hpp"

#include <BOPAlgo_BOP.hxx>
#include <BOPAlgo_PaveFiller.hxx>
#include <NCollection_DataMap.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <algorithm>
#include <array>
#include <deque>
#include <string_view>

#include "face_moments.hpp"
#include "meso/base/number.hpp"
#include "point_in_solid.hpp"
#include "point_within.hpp"
#include "slabs.hpp"
#include "stop_watch.hpp"

namespace meso::brep {
namespace {

constexpr double volume_tolerance = 1e-6;  ///< relative, of the identity
// Surfaces that nearly coincide intersect in edges that are barely known; those agree with every identity and are
// wrong.
constexpr double edge_tolerance_mm = 1e-4;
// Measured, see docs/architecture-cutters.md: 128 and 256 take as long, and 256 more memory.
constexpr std::size_t slab_tools = 128;
constexpr std::size_t points_each = 16;  ///< of a piece, looked at one by one
constexpr std::size_t points_an_edge = 5;
constexpr std::size_t points_a_face = 3;  ///< along each parameter

std::vector<Bnd_Box> boxes_of(const Solids& solids) {
  std::vector<Bnd_Box> boxes(solids.size());
  for (std::size_t i = 0; i < solids.size(); ++i) BRepBndLib::Add(solids[i], boxes[i]);
  return boxes;
}

Solids near(const Solids& solids, const Solids& others) {
  const std::vector<Bnd_Box> other_boxes = boxes_of(others);
  Solids out;
  std::ranges::copy_if(solids, std::back_inserter(out), [&](const TopoDS_Shape& solid) {
    Bnd_Box box;
    BRepBndLib::Add(solid, box);
    return std::ranges::any_of(other_boxes, [&](const Bnd_Box& other) { return !box.IsOut(other); });
  });
  return out;
}

/// Solids that are connected by boxes that meet, in order of their first.
std::vector<Solids> groups_by_box(const Solids& solids) {
  const std::vector<Bnd_Box> boxes = boxes_of(solids);
  std::vector<bool> taken(solids.size(), false);
  std::vector<Solids> groups;
  for (std::size_t first = 0; first < solids.size(); ++first) {
    if (taken[first]) continue;
    std::vector<std::size_t> members{first};
    taken[first] = true;
    for (std::size_t m = 0; m < members.size(); ++m)
      for (std::size_t i = first + 1; i < solids.size(); ++i) {
        if (taken[i] || boxes[members[m]].IsOut(boxes[i])) continue;
        taken[i] = true;
        members.push_back(i);
      }
    std::ranges::sort(members);
    Solids& group = groups.emplace_back();
    for (const std::size_t m : members) group.push_back(solids[m]);
  }
  return groups;
}

TopTools_ListOfShape to_list(const Solids& solids) {
  TopTools_ListOfShape list;
  for (const TopoDS_Shape& solid : solids) list.Append(solid);
  return list;
}

std::string_view name_of(BOPAlgo_Operation operation) {
  return operation == BOPAlgo_FUSE ? "union" : operation == BOPAlgo_COMMON ? "intersection" : "difference";
}

/// Of edges and their ends.
double edge_tolerance(const TopoDS_Shape& shape) {
  double largest = 0;
  for (TopExp_Explorer it(shape, TopAbs_VERTEX); it.More(); it.Next())
    largest = std::max(largest, BRep_Tool::Tolerance(TopoDS::Vertex(it.Current())));
  for (TopExp_Explorer it(shape, TopAbs_EDGE); it.More(); it.Next())
    largest = std::max(largest, BRep_Tool::Tolerance(TopoDS::Edge(it.Current())));
  return largest;
}

/// Faces that a boolean has not divided are integrated once, in whatever solids they are.
class Volumes {
 public:
  double of(const TopoDS_Shape& shape) {
    double volume = 0;
    for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) {
      const TopAbs_Orientation way = it.Current().Orientation();
      if (way == TopAbs_FORWARD || way == TopAbs_REVERSED)
        volume += (way == TopAbs_FORWARD ? 1 : -1) * of_forward(it.Current().Oriented(TopAbs_FORWARD));
    }
    return volume;
  }

 private:
  double of_forward(const TopoDS_Shape& face) {
    if (const double* known = known_.Seek(face)) return *known;
    const double volume = volume_of(face);
    known_.Bind(face, volume);
    return volume;
  }

  NCollection_DataMap<TopoDS_Shape, double, TopTools_ShapeMapHasher> known_;
};

/// The pieces that an operation splits its arguments into, and whose piece each is.
class Pieces {
 public:
  explicit Pieces(Volumes& volumes) : volumes_(volumes) {}

  /// False if the pieces of an argument do not have its volume.
  bool add(const BOPAlgo_BOP& operation, const TopoDS_Shape& argument, bool is_tool) {
    TopTools_ListOfShape images;
    if (!operation.Images().Find(argument, images)) images.Append(argument);
    double sum = 0;
    for (const TopoDS_Shape& image : images) {
      const TopoDS_Shape* same = operation.ShapesSD().Seek(image);
      const int index = pieces_.Add(same != nullptr ? *same : image);
      if (static_cast<std::size_t>(index) > owners_.size())
        owners_.push_back({0, 0, std::fabs(volumes_.of(image)), {}});
      Owners& owners = owners_[static_cast<std::size_t>(index) - 1];
      (is_tool ? owners.tools : owners.objects) += 1;
      owners.arguments.push_back(arguments_.size());
      sum += owners.volume;
    }
    arguments_.push_back(argument);
    const double whole = volumes_.of(argument);
    return std::fabs(sum - whole) <= volume_tolerance * whole;
  }

  /// Whether a piece reaches out of an argument it came from, or into another. That happens where surfaces almost
  /// coincide and were not split along each other, and every sum still holds.
  [[nodiscard]] bool misplaced() const {
    std::deque<PointInSolid> arguments;  // they cannot be moved
    for (const TopoDS_Shape& argument : arguments_) arguments.emplace_back(argument);
    const auto is_owner = [&](const Owners& piece, std::size_t a) {
      return std::ranges::count(piece.arguments, a) > 0;
    };
    for (std::size_t i = 0; i < owners_.size(); ++i) {
      const Owners& piece = owners_[i];
      const std::vector<Vec3> points = points_within(pieces_(static_cast<int>(i) + 1), points_each);
      for (std::size_t a = 0; a < arguments_.size(); ++a) {
        const auto is_beyond = [&](Vec3 p) { return arguments[a].is_beyond_box(p); };
        if (is_owner(piece, a) && std::ranges::any_of(points, is_beyond)) return true;
        const auto contradictions = std::ranges::count_if(points, [&](Vec3 p) {
          return !is_beyond(p) &&
                 arguments[a].state(p, Precision::Confusion()) == (is_owner(piece, a) ? TopAbs_OUT : TopAbs_IN);
        });
        if (contradictions >= 2) return true;  // a single classification can fail by chance
      }
    }
    return reaches_into(TopAbs_EDGE, arguments) || reaches_into(TopAbs_FACE, arguments);
  }

  /// Whether an edge or a face is within an argument that none of its pieces comes from: a piece has it that should
  /// have been divided, and few of its faces' middles may tell. They may lie on an argument, known as they are.
  [[nodiscard]] bool reaches_into(TopAbs_ShapeEnum kind, std::deque<PointInSolid>& arguments) const {
    TopTools_IndexedMapOfShape parts;
    std::vector<std::vector<std::size_t>> owners;  // per part: the arguments of all its pieces
    for (std::size_t i = 0; i < owners_.size(); ++i)
      for (TopExp_Explorer it(pieces_(static_cast<int>(i) + 1), kind); it.More(); it.Next()) {
        const auto part = static_cast<std::size_t>(parts.Add(it.Current()));
        if (part > owners.size()) owners.emplace_back();
        owners[part - 1].insert(owners[part - 1].end(), owners_[i].arguments.begin(), owners_[i].arguments.end());
      }
    for (std::size_t i = 0; i < owners.size(); ++i) {
      const auto is_owner = [&](std::size_t a) { return std::ranges::count(owners[i], a) > 0; };
      bool is_of_all = true;
      for (std::size_t a = 0; a < arguments.size(); ++a) is_of_all = is_of_all && is_owner(a);
      if (is_of_all) continue;
      const TopoDS_Shape& part = parts(static_cast<int>(i) + 1);
      const std::vector<Vec3> points =
          kind == TopAbs_EDGE ? points_along_edges(part, points_an_edge) : points_on_faces(part, points_a_face);
      for (std::size_t a = 0; a < arguments.size(); ++a) {
        if (is_owner(a)) continue;
        const auto within = std::ranges::count_if(
            points, [&](Vec3 p) { return arguments[a].state(p, 2 * edge_tolerance_mm) == TopAbs_IN; });
        if (within >= 2) return true;
      }
    }
    return false;
  }

  [[nodiscard]] double expected(BOPAlgo_Operation operation) const {
    double sum = 0;
    for (const Owners& piece : owners_) {
      const bool kept = operation == BOPAlgo_FUSE     ? true
                        : operation == BOPAlgo_COMMON ? piece.objects > 0 && piece.tools > 0
                                                      : piece.objects > 0 && piece.tools == 0;
      if (kept) sum += piece.volume;
    }
    return sum;
  }
  [[nodiscard]] double total() const {
    double sum = 0;
    for (const Owners& piece : owners_) sum += piece.volume;
    return sum;
  }

 private:
  struct Owners {
    int objects, tools;
    double volume;
    std::vector<std::size_t> arguments;
  };
  Volumes& volumes_;
  std::vector<TopoDS_Shape> arguments_;
  TopTools_IndexedMapOfShape pieces_;
  std::vector<Owners> owners_;
};

struct Attempt {
  std::optional<Solids> solids;
  CutImages images;   ///< of the objects
  std::string fault;  ///< why not
};

std::optional<std::string> fault_of(const BOPAlgo_BOP& operation, BOPAlgo_Operation kind, const Solids& objects,
                                    const Solids& tools, const Solids& result, Volumes& volumes) {
  Pieces pieces(volumes);
  for (const TopoDS_Shape& object : objects)
    if (!pieces.add(operation, object, false)) return "the pieces of a body do not add up to it";
  for (const TopoDS_Shape& tool : tools)
    if (!pieces.add(operation, tool, true)) return "the pieces of a body do not add up to it";
  double volume = 0;
  for (const TopoDS_Shape& solid : result) {
    if (edge_uses(solid).free > 0) return "the result is not closed";
    if (const double tolerance = edge_tolerance(solid); tolerance > edge_tolerance_mm)
      return "an edge is only known to " + format_number(tolerance) + " mm";
    volume += volumes.of(solid);
  }
  const double expected = pieces.expected(kind);
  if (std::fabs(volume - expected) <= volume_tolerance * pieces.total()) {
    if (pieces.misplaced()) return "a piece is not where it comes from";
    return {};
  }
  return "its volume is " + format_number(volume) + " mm3 where the pieces have " + format_number(expected) + " mm3";
}

CutImages images_of(const Solids& objects, BOPAlgo_BOP& operation) {
  TopTools_IndexedMapOfShape parts;
  for (const TopoDS_Shape& object : objects)
    for (const auto kind : {TopAbs_FACE, TopAbs_EDGE, TopAbs_VERTEX}) TopExp::MapShapes(object, kind, parts);
  CutImages images;
  for (int i = 1; i <= parts.Extent(); ++i)
    if (const TopTools_ListOfShape& left = operation.Modified(parts(i));
        !left.IsEmpty() || operation.IsDeleted(parts(i)))
      images.Bind(parts(i), left);
  return images;
}

Attempt attempt(BOPAlgo_Operation kind, const Solids& objects, const Solids& tools, double fuzzy,
                const RunOptions& run) {
  Solids all = objects;
  all.insert(all.end(), tools.begin(), tools.end());
  const Handle(StopWatch) watch = new StopWatch(run);
  const Message_ProgressRange range = watch->Start();
  Message_ProgressScope scope(range, "boolean", 2);
  BOPAlgo_PaveFiller filler;
  filler.SetArguments(to_list(all));
  filler.SetNonDestructive(true);
  filler.SetRunParallel(true);
  filler.SetUseOBB(true);
  filler.SetFuzzyValue(fuzzy);
  filler.Perform(scope.Next());
  if (filler.HasErrors()) return {{}, {}, "the bodies cannot be intersected"};
  BOPAlgo_BOP operation;
  for (const TopoDS_Shape& object : objects) operation.AddArgument(object);
  for (const TopoDS_Shape& tool : tools) operation.AddTool(tool);
  operation.SetOperation(kind);
  operation.SetRunParallel(true);
  operation.PerformWithFiller(filler, scope.Next());
  if (operation.HasErrors() || operation.Shape().IsNull()) return {{}, {}, "the pieces cannot be put together"};
  TopoDS_Shape whole = operation.Shape();
  BRepTools::RemoveInternals(
      whole);  // a point where surfaces touch bounds nothing, and the mesher fails on two of them
  Volumes volumes;
  Solids result;
  for (TopExp_Explorer it(whole, TopAbs_SOLID); it.More(); it.Next())
    result.push_back(volumes.of(it.Current()) < 0 ? it.Current().Reversed() : it.Current());
  if (auto fault = fault_of(operation, kind, objects, tools, result, volumes)) return {{}, {}, *fault};
  return {std::move(result), images_of(objects, operation), {}};
}

void warn_of_contacts(const Solids& solids, ElementId where, const SolidContext& context) {
  std::size_t multiple = 0;
  for (const TopoDS_Shape& solid : solids) multiple += edge_uses(solid).multiple;
  if (multiple > 0) context.report(Code::geometry_non_manifold, where, {std::to_string(multiple)});
}

/// Two alike that start from one point meet in plane curves with a corner; at its least tolerance OpenCASCADE follows
/// an edge there that it has not made, and ends the process.
bool have_two_cones(const Solids& objects, const Solids& tools) {
  std::size_t cones = 0;
  for (const Solids* solids : {&objects, &tools})
    for (const TopoDS_Shape& solid : *solids)
      for (TopExp_Explorer it(solid, TopAbs_FACE); it.More(); it.Next())
        cones += BRepAdaptor_Surface(TopoDS::Face(it.Current()), Standard_False).GetType() == GeomAbs_Cone;
  return cones > 1;
}

std::optional<Solids> checked(BOPAlgo_Operation kind, const Solids& objects, const Solids& tools, ElementId where,
                              const SolidContext& context, CutImages* images = nullptr) {
  std::string fault;
  std::vector<double> ladder{0.0, 1e-6, 1e-5};
  if (have_two_cones(objects, tools)) ladder.erase(ladder.begin());
  for (const double fuzzy : ladder) {
    if (context.run.should_stop()) break;
    try {
      Attempt result = attempt(kind, objects, tools, fuzzy, context.run);
      if (result.solids) {
        if (images != nullptr) *images = std::move(result.images);
        return std::move(result.solids);
      }
      if (fault.empty()) fault = result.fault;
    } catch (const Standard_Failure& failure) {
      if (fault.empty()) fault = what(failure);
    }
  }
  if (context.run.should_stop())
    context.report(context.run.out_of_time() ? Code::limit_time : Code::cancelled, where, {});
  else
    context.report(Code::geometry_boolean, where,
                   {std::string(name_of(kind)), std::to_string(objects.size() + tools.size()), fault});
  return {};
}

}  // namespace

double volume_of(const TopoDS_Shape& shape) {
  double volume = 0;
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) {
    const Vec3 m = face_moments(TopoDS::Face(it.Current())).volume_moment;
    volume += (m.x + m.y + m.z) / 3;
  }
  return volume;
}

Box3 box_of(const TopoDS_Shape& shape) {
  Box3 box;
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) {
    const Box3 face = face_box(TopoDS::Face(it.Current()));
    box.extend(face.min);
    box.extend(face.max);
  }
  return box;
}

EdgeUses edge_uses(const TopoDS_Shape& shape) {
  TopTools_IndexedMapOfShape edges;
  std::vector<int> uses;
  for (TopExp_Explorer faces(shape, TopAbs_FACE); faces.More(); faces.Next())
    for (TopExp_Explorer it(faces.Current(), TopAbs_EDGE); it.More(); it.Next()) {
      if (BRep_Tool::Degenerated(TopoDS::Edge(it.Current()))) continue;
      const auto index = static_cast<std::size_t>(edges.Add(it.Current()));
      if (index > uses.size()) uses.push_back(0);
      ++uses[index - 1];
    }
  return {static_cast<std::size_t>(std::ranges::count(uses, 1)),
          static_cast<std::size_t>(std::ranges::count_if(uses, [](int n) { return n > 2; }))};
}

Solids solids_of(const TopoDS_Shape& shape) {
  Solids solids;
  for (TopExp_Explorer it(shape, TopAbs_SOLID); it.More(); it.Next()) {
    const TopoDS_Shape& solid = it.Current();
    solids.push_back(volume_of(solid) < 0 ? solid.Reversed() : solid);
  }
  return solids;
}

std::optional<Solids> fuse(const Solids& operands, ElementId where, const SolidContext& context) {
  Solids all;
  for (const Solids& group : groups_by_box(operands)) {
    const auto joined = group.size() < 2
                            ? std::optional(group)
                            : checked(BOPAlgo_FUSE, {group.front()}, {group.begin() + 1, group.end()}, where, context);
    if (!joined) return {};
    if (group.size() > 1) warn_of_contacts(*joined, where, context);
    all.insert(all.end(), joined->begin(), joined->end());
  }
  return all;
}

std::optional<Solids> common(const Solids& a, const Solids& b, ElementId where, const SolidContext& context) {
  const Solids near_a = near(a, b), near_b = near(b, a);
  if (near_a.empty() || near_b.empty()) return Solids{};
  auto shared = checked(BOPAlgo_COMMON, near_a, near_b, where, context);
  if (shared) warn_of_contacts(*shared, where, context);
  return shared;
}

std::optional<Solids> cut(const Solids& base, const Solids& tools, ElementId where, const SolidContext& context) {
  const Solids near_tools = near(tools, base);
  if (near_tools.size() > slab_tools) return cut(base, groups_by_box(near_tools), where, context);
  return cut(base, std::vector<Solids>{near_tools}, where, context);
}

std::optional<Solids> cut(const Solids& base, const std::vector<Solids>& clusters, ElementId where,
                          const SolidContext& context) {
  if (base.empty() || std::ranges::all_of(clusters, &Solids::empty)) return base;
  // A slab pays for all faces of the base again.
  TopTools_IndexedMapOfShape faces;
  for (const TopoDS_Shape& solid : base) TopExp::MapShapes(solid, TopAbs_FACE, faces);
  const auto size = std::max(slab_tools, static_cast<std::size_t>(faces.Extent()));
  auto left = cut_in_slabs(base, clusters, size, where, context);
  if (left) warn_of_contacts(*left, where, context);
  return left;
}

std::optional<Solids> cut_at_once(const Solids& base, const Solids& tools, ElementId where, const SolidContext& context,
                                  CutImages* images) {
  return checked(BOPAlgo_CUT, base, tools, where, context, images);
}

}  // namespace meso::brep
