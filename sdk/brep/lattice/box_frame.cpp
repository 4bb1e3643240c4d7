// SPDX-License-Identifier: Apache-2.0
#include "lattice/box_frame.hpp"

#include <TopTools_MapOfShape.hxx>

#include "face_moments.hpp"
#include "lattice/divided_faces.hpp"
#include "stop_watch.hpp"

namespace meso::brep {
namespace {

constexpr double tiny = 1e-6;  ///< relative to the cell: of lengths, areas and volumes

double size_of(const Box3& box) {
  const Vec3 d = box.max - box.min;
  return std::fmin(d.x, std::fmin(d.y, d.z));
}

/// 2 * axis + (0 low, 1 high); -1: the face is not in a side of the box.
int side_of(const TopoDS_Face& face, const Box3& box, double tolerance) {
  if (BRepAdaptor_Surface(face, false).GetType() != GeomAbs_Plane) return -1;
  for (int side = 0; side < 6; ++side) {
    const auto axis = static_cast<std::size_t>(side / 2);
    const double at = side % 2 != 0 ? box.max[axis] : box.min[axis];
    bool all = true;
    for (TopExp_Explorer it(face, TopAbs_EDGE); it.More() && all; it.Next()) {
      const BRepAdaptor_Curve curve(TopoDS::Edge(it.Current()));
      for (const double t : {0.0, 0.3, 0.6})
        all = all && std::fabs(to_vec(curve.Value((1 - t) * curve.FirstParameter() + t * curve.LastParameter()))[axis] -
                               at) <= tolerance;
    }
    if (all) return side;
  }
  return -1;
}

/// All faces of a frame before they are meshed, those of the space first.
struct Frame {
  std::vector<TopoDS_Face> faces;
  std::vector<WholeCell::Role> roles;
  std::size_t of_space = 0;
  double left_out = 0;
};

double area_of(const std::vector<TopoDS_Face>& faces) {
  double area = 0;
  for (const TopoDS_Face& face : faces) area += face_moments(face).area;
  return area;
}

/// The sides, and the faces of the solid, divided along each other.
Frame divided_frame(const TopoDS_Shape& solid, const Box3& box, const std::vector<TopoDS_Shape>& outlines, double fuzzy,
                    const RunOptions& run) {
  using Role = WholeCell::Role;
  const auto copy_of = [](const TopoDS_Shape& shape) {
    return BRepBuilderAPI_Copy(shape, Standard_True, Standard_False).Shape();
  };
  const std::vector<TopoDS_Face> sides = faces_in(BRepPrimAPI_MakeBox(to_pnt(box.min), to_pnt(box.max)).Solid());
  std::vector<TopoDS_Face> own;
  if (!solid.IsNull()) own = faces_in(copy_of(solid));
  BOPAlgo_Builder builder;
  const Handle(IntTools_Context) context = new IntTools_Context;
  const bool is_divided = !own.empty() || !outlines.empty();
  if (is_divided) {
    const Handle(StopWatch) watch = new StopWatch(run);
    builder.AddArgument(compound_of(sides));
    if (!own.empty()) builder.AddArgument(compound_of(own));
    for (const TopoDS_Shape& outline : outlines) builder.AddArgument(copy_of(outline));
    builder.SetFuzzyValue(fuzzy);
    builder.SetNonDestructive(Standard_True);
    builder.Perform(watch->Start());
    if (builder.HasErrors()) throw Standard_Failure("the sides of a box cannot be divided");
  }
  const auto pieces = [&](const TopoDS_Face& face) {
    return is_divided ? pieces_of(builder, face, context) : std::vector{face};
  };
  const double tolerance = 4 * tiny * size_of(box);
  Frame out;
  std::vector<TopoDS_Face> walls;
  TopTools_MapOfShape is_wall;
  for (const TopoDS_Face& face : own) {
    out.left_out += share_of(face_moments(face));
    const bool wall = side_of(face, box, tolerance) >= 0;
    for (const TopoDS_Face& piece : pieces(face)) {
      if (wall) {
        walls.push_back(piece);
        is_wall.Add(piece);
      } else {
        out.faces.push_back(TopoDS::Face(piece.Reversed()));
        out.roles.push_back(Role::skin);
      }
    }
  }
  std::vector<TopoDS_Face> solid_walls;
  for (const TopoDS_Face& side : sides) {
    const std::vector<TopoDS_Face> parts = pieces(side);
    if (std::fabs(area_of(parts) - area_of({side})) > tiny * size_of(box) * size_of(box))
      throw Standard_Failure("the sides of a box do not add up");
    for (const TopoDS_Face& piece : parts) {
      if (is_wall.Contains(piece)) {
        solid_walls.push_back(piece);
      } else {
        out.faces.push_back(piece);
        out.roles.push_back(Role::open_wall);
      }
    }
  }
  if (solid_walls.size() != walls.size()) throw Standard_Failure("the walls of a box are not in its sides");
  out.of_space = out.faces.size();
  out.faces.insert(out.faces.end(), solid_walls.begin(), solid_walls.end());
  out.roles.resize(out.faces.size(), Role::solid_wall);
  return out;
}

/// As exact as it can be.
Frame frame_of(const TopoDS_Shape& solid, const Box3& box, const std::vector<TopoDS_Shape>& outlines,
               const RunOptions& run) {
  const double a = tiny * size_of(box);
  for (const double fuzzy : {0.0, a}) {
    try {
      return divided_frame(solid, box, outlines, fuzzy, run);
    } catch (const Standard_Failure&) {
    }
  }
  return divided_frame(solid, box, outlines, 10 * a, run);
}

TopoDS_Solid solid_of(const std::vector<TopoDS_Face>& faces, std::size_t count) {
  const BRep_Builder builder;
  TopoDS_Shell shell;
  builder.MakeShell(shell);
  for (std::size_t f = 0; f < count; ++f) builder.Add(shell, faces[f]);
  shell.Closed(Standard_True);
  TopoDS_Solid solid;
  builder.MakeSolid(solid);
  builder.Add(solid, shell);
  return solid;
}

}  // namespace

bool WallFaces::is_same(const WallFaces& other, Vec3 shift, double size) const {
  const double area_tolerance = 10 * tiny * size * size;
  return std::fabs(area - other.area) <= area_tolerance &&
         norm(other.moment + other.area * shift - moment) <= area_tolerance * size;
}

BoxWalls walls_of(const TopoDS_Shape& solid, const Box3& box, double tolerance) {
  BoxWalls out;
  if (solid.IsNull()) return out;
  for (const TopoDS_Face& face : faces_in(solid)) {
    const int side = side_of(face, box, tolerance);
    if (side < 0) continue;
    WallFaces& walls = out[static_cast<std::size_t>(side)];
    GProp_GProps area;
    BRepGProp::SurfaceProperties(face, area);
    walls.faces.push_back(face);
    walls.area += area.Mass();
    walls.moment += area.Mass() * to_vec(area.CentreOfMass());
  }
  return out;
}

WholeCell box_frame(const TopoDS_Shape& solid, const Box3& box, const std::vector<TopoDS_Shape>& outlines,
                    double deflection, const RunOptions& run) {
  const Frame frame = frame_of(solid, box, outlines, run);
  WholeCell out;
  out.reach = 3 * deflection;
  out.is_frame = true;
  out.left_out = frame.left_out;
  BRepMesh_IncrementalMesh(compound_of(frame.faces), deflection, Standard_False, 0.3);
  for (std::size_t f = 0; f < frame.faces.size(); ++f) out.add(frame.faces[f], frame.roles[f]);
  out.solids.emplace_back(solid_of(frame.faces, frame.of_space));
  const Vec3 d = box.max - box.min;
  if (std::fabs(out.volume + out.left_out - d.x * d.y * d.z) > tiny * d.x * d.y * d.z)
    throw Standard_Failure("a box is not its solids and the space beside them");
  return out;
}

TopoDS_Shape filled_box(const Box3& box, const std::vector<TopoDS_Shape>& outlines, const RunOptions& run) {
  const Frame frame = frame_of({}, box, outlines, run);
  return compound_of(std::vector<TopoDS_Shape>{solid_of(frame.faces, frame.faces.size())});
}

}  // namespace meso::brep
