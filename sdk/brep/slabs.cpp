// SPDX-License-Identifier: Apache-2.0
#include "slabs.hpp"

#include <BOPAlgo_BuilderFace.hxx>
#include <BOPAlgo_BuilderSolid.hxx>
#include <BOPTools_AlgoTools.hxx>
#include <BRepTools_ReShape.hxx>
#include <TopTools_DataMapOfShapeInteger.hxx>
#include <algorithm>
#include <map>
#include <numeric>

#include "boolean.hpp"
#include "lattice/parallel.hpp"
#include "stop_watch.hpp"

namespace meso::brep {
namespace {

constexpr double volume_tolerance = 1e-6;  ///< relative

/// Clusters in their order along the longest axis, dealt out in turn.
std::vector<Solids> slabs_of(const std::vector<Solids>& clusters, std::size_t slab_tools) {
  Box3 all;
  std::vector<Box3> boxes(clusters.size());
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    for (const TopoDS_Shape& tool : clusters[i]) {
      const Box3 box = box_of(tool);
      boxes[i].extend(box.min);
      boxes[i].extend(box.max);
    }
    all.extend(boxes[i].min);
    all.extend(boxes[i].max);
  }
  std::size_t axis = 0;
  for (std::size_t a = 1; a < 3; ++a)
    if (all.max[a] - all.min[a] > all.max[axis] - all.min[axis]) axis = a;
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < clusters.size(); ++i) order.emplace_back(boxes[i].min[axis], i);
  std::ranges::sort(order);
  std::vector<Solids> slabs;
  for (const auto& [start, i] : order) {
    if (slabs.empty() || slabs.back().size() + clusters[i].size() > slab_tools) slabs.emplace_back();
    slabs.back().insert(slabs.back().end(), clusters[i].begin(), clusters[i].end());
  }
  return slabs;
}

TopoDS_Compound compound_of(const Solids& solids) {
  TopoDS_Compound compound;
  const BRep_Builder builder;
  builder.MakeCompound(compound);
  for (const TopoDS_Shape& solid : solids) builder.Add(compound, solid);
  return compound;
}

/// Topology of its own, so that threads do not meet in it, on the same curves and surfaces.
TopoDS_Shape copy_of(const TopoDS_Shape& shape) { return BRepBuilderAPI_Copy(shape, false, false).Shape(); }

double sum_of_volumes(const Solids& solids) {
  double sum = 0;
  for (const TopoDS_Shape& solid : solids) sum += volume_of(solid);
  return sum;
}

bool is_on_surface_of(const TopoDS_Face& a, const TopoDS_Face& b) {
  TopLoc_Location of_a, of_b;
  return BRep_Tool::Surface(a, of_a) == BRep_Tool::Surface(b, of_b) && of_a == of_b;
}

struct Slab {
  TopoDS_Shape base;  ///< a copy
  Solids tools;
  std::optional<Solids> left;
  CutImages images{};  ///< of the copy
  double volume = 0;   ///< of what is left
  DiagnosticSink sink{};
};

void cut_slab(Slab& slab, ElementId where, const SolidContext& context) {
  const SolidContext own{context.source, context.run, slab.sink};
  slab.left = cut_at_once(solids_of(slab.base), slab.tools, where, own, &slab.images);
  if (slab.left) slab.volume = sum_of_volumes(*slab.left);
}

/// What is left of a body whose slabs were cut from copies. Faces, edges and vertices of the body are known by their
/// number in it, which the copies share.
class Rest {
 public:
  Rest(const TopoDS_Shape& base, const std::vector<Slab>& slabs, const RunOptions& run) : slabs_(slabs), run_(run) {
    TopExp::MapShapes(base, parts_);
    changed_in_.resize(static_cast<std::size_t>(parts_.Extent()) + 1);
    pieces_.resize(changed_in_.size());
    left_.resize(changed_in_.size());
    split_.resize(changed_in_.size());
  }

  /// Nothing where the slabs do not fit together. May throw Standard_Failure.
  std::optional<Solids> solids() {
    for (std::size_t k = 0; k < slabs_.size(); ++k)
      if (!take(k)) return {};
    for (int i = 1; i <= parts_.Extent(); ++i)
      if (parts_(i).ShapeType() == TopAbs_EDGE && changed_in(i).size() > 1 && !split(i)) return {};
    for (int i = 1; i <= parts_.Extent(); ++i)
      if (parts_(i).ShapeType() == TopAbs_FACE && !settle(i)) return {};
    return assembled();
  }

 private:
  using Edges = std::vector<TopoDS_Edge>;

  [[nodiscard]] const std::vector<std::size_t>& changed_in(int part) const {
    return changed_in_[static_cast<std::size_t>(part)];
  }

  /// Back from the copy to the body: what the slab has not changed is the body's own again.
  bool take(std::size_t k) {
    const Slab& slab = slabs_[k];
    TopTools_IndexedMapOfShape copies;
    TopExp::MapShapes(slab.base, copies);
    if (copies.Extent() != parts_.Extent()) return false;
    const Handle(BRepTools_ReShape) back = new BRepTools_ReShape;
    back->ModeConsiderLocation() = true;
    TopTools_DataMapOfShapeInteger face_owner;
    for (int i = 1; i <= copies.Extent(); ++i) {
      if (copies(i).ShapeType() != parts_(i).ShapeType()) return false;
      if (copies(i).ShapeType() < TopAbs_FACE || copies(i).ShapeType() == TopAbs_WIRE) continue;
      const TopTools_ListOfShape* images = slab.images.Seek(copies(i));
      if (images == nullptr) {
        back->Replace(copies(i).Oriented(TopAbs_FORWARD), parts_(i).Oriented(TopAbs_FORWARD));
        continue;
      }
      changed_in_[static_cast<std::size_t>(i)].push_back(k);
      if (copies(i).ShapeType() == TopAbs_VERTEX && !images->IsEmpty()) return false;
      if (copies(i).ShapeType() == TopAbs_FACE)
        for (const TopoDS_Shape& image : *images) face_owner.Bind(image, i);
    }
    for (const TopoDS_Shape& solid : *slab.left)
      for (TopExp_Explorer it(solid, TopAbs_FACE); it.More(); it.Next()) {
        if (copies.Contains(it.Current()) && !slab.images.IsBound(it.Current())) continue;
        const TopoDS_Face face = TopoDS::Face(back->Apply(it.Current()));
        if (const int* owner = face_owner.Seek(it.Current()))
          left_[static_cast<std::size_t>(*owner)].push_back(face);
        else
          faces_.Append(face);
      }
    for (int i = 1; i <= copies.Extent(); ++i)
      if (copies(i).ShapeType() == TopAbs_EDGE && slab.images.IsBound(copies(i)))
        for (const TopoDS_Shape& image : slab.images.Find(copies(i))) {
          const TopoDS_Edge piece = TopoDS::Edge(back->Apply(image));
          owner_of_piece_.Bind(piece, i);
          pieces_[static_cast<std::size_t>(i)].push_back({k, piece});
        }
    return true;
  }

  /// The parts of an edge that all slabs leave, where several have changed it.
  bool split(int part) {
    const TopoDS_Edge edge = TopoDS::Edge(parts_(part).Oriented(TopAbs_FORWARD));
    if (BRep_Tool::Degenerated(edge)) return false;
    TopLoc_Location location;
    double first = 0, last = 0;
    const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, location, first, last);
    struct Interval {
      std::size_t slab;
      double from, to;
    };
    struct Cut {
      double at;
      TopoDS_Vertex vertex;
    };
    std::vector<Interval> intervals;
    std::vector<Cut> cuts;
    for (const auto& [slab, piece] : pieces_[static_cast<std::size_t>(part)]) {
      TopLoc_Location its_location;
      const TopoDS_Edge forward = TopoDS::Edge(piece.Oriented(TopAbs_FORWARD));
      if (BRep_Tool::Curve(forward, its_location, first, last) != curve || its_location != location) return false;
      intervals.push_back({slab, first, last});
      cuts.push_back({first, TopExp::FirstVertex(forward)});
      cuts.push_back({last, TopExp::LastVertex(forward)});
    }
    std::ranges::stable_sort(cuts, {}, [](const Cut& cut) { return cut.at; });
    for (std::size_t c = 0; c + 1 < cuts.size(); ++c) {
      if (cuts[c].at == cuts[c + 1].at) continue;
      const double middle = (cuts[c].at + cuts[c + 1].at) / 2;
      const bool is_left = std::ranges::all_of(changed_in(part), [&](std::size_t slab) {
        return std::ranges::any_of(
            intervals, [&](const Interval& i) { return i.slab == slab && i.from < middle && middle < i.to; });
      });
      if (!is_left) continue;
      TopoDS_Edge piece;
      BOPTools_AlgoTools::MakeSplitEdge(edge, cuts[c].vertex, cuts[c].at, cuts[c + 1].vertex, cuts[c + 1].at, piece);
      split_[static_cast<std::size_t>(part)].push_back(piece);
    }
    return true;
  }

  /// The faces that are left of one face of the body.
  bool settle(int part) {
    const auto& left = left_[static_cast<std::size_t>(part)];
    if (changed_in(part).empty()) {
      faces_.Append(parts_(part));
      return true;
    }
    if (changed_in(part).size() == 1) {
      for (const TopoDS_Face& face : left) faces_.Append(face);
      return true;
    }
    const TopoDS_Face face = TopoDS::Face(parts_(part).Oriented(TopAbs_FORWARD));
    TopTools_ListOfShape edges;
    for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
      const int edge = parts_.FindIndex(it.Current());
      if (changed_in(edge).empty()) edges.Append(it.Current());
      for (const TopoDS_Edge& piece : split_[static_cast<std::size_t>(edge)])
        edges.Append(piece.Oriented(it.Current().Orientation()));
    }
    for (const TopoDS_Face& one : left) {
      if (!is_on_surface_of(one, face) || one.Orientation() != parts_(part).Orientation()) return false;
      for (TopExp_Explorer it(one.Oriented(TopAbs_FORWARD), TopAbs_EDGE); it.More(); it.Next()) {
        if (parts_.Contains(it.Current())) continue;
        const int* owner = owner_of_piece_.Seek(it.Current());
        if (owner == nullptr || changed_in(*owner).size() == 1) edges.Append(it.Current());
      }
    }
    BOPAlgo_BuilderFace builder;
    builder.SetFace(face);
    builder.SetShapes(edges);
    builder.Perform();
    if (builder.HasErrors()) return false;
    for (const TopoDS_Shape& area : builder.Areas()) faces_.Append(area.Oriented(parts_(part).Orientation()));
    return true;
  }

  std::optional<Solids> assembled() const {
    std::optional<Solids> solids = one_solid();
    if (!solids) solids = solids_by_occt();
    if (!solids) return {};
    const double whole = sum_of_volumes(solids_of(slabs_.front().base));
    double expected = whole;
    for (const Slab& slab : slabs_) expected += slab.volume - whole;
    if (std::fabs(sum_of_volumes(*solids) - expected) > volume_tolerance * whole) return {};
    for (const TopoDS_Shape& solid : *solids)
      if (edge_uses(solid).free > 0) return {};
    return solids;
  }

  /// Faces that share edges are a shell, and where one shell alone looks outwards, the others are its voids. Nothing
  /// where that does not tell all. OpenCASCADE takes four times as long for twice as many faces.
  std::optional<Solids> one_solid() const {
    const std::vector<TopoDS_Shape> faces(faces_.begin(), faces_.end());
    std::vector<std::size_t> first(faces.size());  // face of the same shell, smaller unless it is the first
    std::iota(first.begin(), first.end(), 0);
    const auto root_of = [&](std::size_t face) {
      while (first[face] != face) face = first[face] = first[first[face]];
      return face;
    };
    TopTools_IndexedMapOfShape edges;
    std::vector<std::pair<std::size_t, int>> uses;  // first face, count
    for (std::size_t f = 0; f < faces.size(); ++f)
      for (TopExp_Explorer it(faces[f], TopAbs_EDGE); it.More(); it.Next()) {
        if (BRep_Tool::Degenerated(TopoDS::Edge(it.Current()))) continue;
        const auto edge = static_cast<std::size_t>(edges.Add(it.Current()));
        if (edge > uses.size()) uses.emplace_back(f, 0);
        if (++uses[edge - 1].second > 2) return {};
        const std::size_t a = root_of(f), b = root_of(uses[edge - 1].first);
        first[std::max(a, b)] = std::min(a, b);
      }
    const BRep_Builder builder;
    std::map<std::size_t, TopoDS_Shell> shells;
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const auto [shell, fresh] = shells.try_emplace(root_of(f));
      if (fresh) builder.MakeShell(shell->second);
      builder.Add(shell->second, faces[f]);
    }
    TopoDS_Solid solid;
    builder.MakeSolid(solid);
    std::size_t outer = 0;
    for (auto& [face, shell] : shells) {
      shell.Closed(true);
      if (volume_of(shell) > 0) ++outer;
      builder.Add(solid, shell);
    }
    if (outer != 1) return {};
    return Solids{solid};
  }

  std::optional<Solids> solids_by_occt() const {
    const Handle(StopWatch) watch = new StopWatch(run_);
    BOPAlgo_BuilderSolid builder;
    builder.SetShapes(faces_);
    builder.SetAvoidInternalShapes(true);
    builder.Perform(watch->Start());
    if (builder.HasErrors()) return {};
    Solids solids;
    for (const TopoDS_Shape& area : builder.Areas()) solids.push_back(solids_of(area).front());
    return solids;
  }

  struct Piece {
    std::size_t slab;
    TopoDS_Edge edge;
  };
  const std::vector<Slab>& slabs_;
  const RunOptions& run_;
  TopTools_IndexedMapOfShape parts_;                  ///< of the body
  std::vector<std::vector<std::size_t>> changed_in_;  ///< slabs, by part, as all that follow
  std::vector<std::vector<Piece>> pieces_;            ///< of edges, as single slabs leave them
  std::vector<std::vector<TopoDS_Face>> left_;        ///< of faces, as single slabs leave them
  std::vector<Edges> split_;                          ///< of edges that several slabs have changed
  TopTools_DataMapOfShapeInteger owner_of_piece_;
  TopTools_ListOfShape faces_;  ///< of the result
};

}  // namespace

std::optional<Solids> cut_in_slabs(const Solids& base, const std::vector<Solids>& clusters, std::size_t slab_tools,
                                   ElementId where, const SolidContext& context) {
  const std::vector<Solids> tools = slabs_of(clusters, slab_tools);
  const auto at_once = [&] {
    Solids all;
    for (const Solids& cluster : clusters) all.insert(all.end(), cluster.begin(), cluster.end());
    return cut_at_once(base, all, where, context);
  };
  if (tools.size() < 2) return at_once();
  const TopoDS_Shape whole = compound_of(base);
  std::vector<Slab> slabs(tools.size());
  for (std::size_t k = 0; k < slabs.size(); ++k) {
    slabs[k].base = copy_of(whole);
    for (const TopoDS_Shape& tool : tools[k]) slabs[k].tools.push_back(copy_of(tool));
  }
  const auto work = [&](std::size_t, std::size_t k) {
    cut_slab(slabs[k], where, context);
    return slabs[k].left.has_value();
  };
  if (!in_parallel(slabs.size(), context.run, work)) {
    const auto failed = std::ranges::find_if(slabs, [](const Slab& slab) { return slab.sink.has_errors(); });
    if (failed != slabs.end())
      for (const Diagnostic& diagnostic : failed->sink.diagnostics()) context.sink.report(diagnostic);
    else
      context.report(context.run.out_of_time() ? Code::limit_time : Code::cancelled, where, {});
    return {};
  }
  try {
    if (auto rest = Rest(whole, slabs, context.run).solids()) return rest;
  } catch (const Standard_Failure&) {
  }
  return at_once();
}

}  // namespace meso::brep
