// SPDX-License-Identifier: Apache-2.0
#pragma once
// An exact boundary representation as plain values: what the B-rep engine makes and every exact sink reads.
//
// A Body is one or more shells. A shell is a stream of face instances (FaceTemplate, lattice index): the template of a
// periodic cell is stored once and instantiated by integer keys, so that a hundred thousand cells need one template and
// a list of indices. A body that is not periodic is a template whose faces all carry index (0,0,0). No OpenCASCADE type
// appears here.
//
// Units: millimetres. Normals: faces are oriented with the material behind them (outward normals) once `reversed` is
// applied.

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <variant>
#include <vector>

#include "meso/base/vec.hpp"

namespace meso::brep {

/// Right-handed local axes: z is the axis of revolution / the plane's normal, x the reference direction (both unit
/// vectors).
struct AxisFrame {
  Vec3 origin;
  Vec3 z{0, 0, 1};
  Vec3 x{1, 0, 0};
};

struct Plane {
  AxisFrame frame;
};
struct CylinderSurface {
  AxisFrame frame;
  double radius = 0;
};
struct ConeSurface {
  AxisFrame frame;
  double radius = 0;      ///< at the frame's origin
  double half_angle = 0;  ///< radians, > 0: the radius grows along z
};
struct SphereSurface {
  AxisFrame frame;
  double radius = 0;
};
struct TorusSurface {
  AxisFrame frame;
  double major_radius = 0, minor_radius = 0;
};
struct BSplineSurface {
  int u_degree = 0, v_degree = 0;
  bool u_closed = false, v_closed = false;
  std::size_t u_count = 0, v_count = 0;  ///< control points; pole(i, j) = poles[i * v_count + j]
  std::vector<Vec3> poles;
  std::vector<double> weights;           ///< empty: not rational
  std::vector<double> u_knots, v_knots;  ///< distinct knots
  std::vector<int> u_multiplicities, v_multiplicities;
};
using Surface = std::variant<Plane, CylinderSurface, ConeSurface, SphereSurface, TorusSurface, BSplineSurface>;

struct Line {
  Vec3 origin, direction;
};
struct Circle {
  AxisFrame frame;
  double radius = 0;
};
struct Ellipse {
  AxisFrame frame;  ///< x: the major axis
  double major_radius = 0, minor_radius = 0;
};
struct BSplineCurve {
  int degree = 0;
  bool closed = false;
  std::vector<Vec3> poles;
  std::vector<double> weights;  ///< empty: not rational
  std::vector<double> knots;
  std::vector<int> multiplicities;
};
using Curve = std::variant<Line, Circle, Ellipse, BSplineCurve>;

/// Integer coordinates in the lattice of a template.
using Index3 = std::array<std::int32_t, 3>;

/// An edge modulo lattice translation. Vertex k of the edge lies in the cell (edge's cell) + vertex_offset[k].
struct EdgeTemplate {
  Curve curve;
  std::array<std::uint32_t, 2> vertex{};
  std::array<Index3, 2> vertex_offset{};
  bool degenerate = false;  ///< no curve: a pole of a sphere, an apex of a cone; never written to STEP
};

/// One use of an edge by a face, in loop order.
struct Coedge {
  std::uint32_t edge = 0;
  Index3 offset{};        ///< the edge's cell is (face's cell) + offset
  bool reversed = false;  ///< against the curve's direction
};

/// A mesh point of an instance in cell c stands at placement * (point + lattice * (c + offset)). Faces that share an
/// edge or a vertex store the same `point` for it and offsets whose sums with the cells agree, so shared points are
/// equal bit for bit.
struct MeshPoint {
  Vec3 point;
  Index3 offset{};
};

struct Triangulation {
  std::vector<MeshPoint> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< outward (after `reversed`)
};

/// A face modulo lattice translation.
struct FaceTemplate {
  Surface surface;
  bool reversed = false;                   ///< material on the side of the surface's own normal
  std::vector<std::vector<Coedge>> loops;  ///< first one is the outer loop where the surface has one
  double area = 0;                         ///< mm^2, exact surface
  double volume_moment = 0;                ///< integral of p.n dA / 3 about the template's origin
  Vec3 vector_area;                        ///< integral of n dA; gives the moment of a translated instance
  Vec3 centroid_moment;                    ///< integral of (p_i^2 / 2) n_i dA for i = x, y, z
  Triangulation mesh;                      ///< filled only when a mesh was asked for
};

/// Faces, edges and vertices modulo the lattice spanned by `lattice` (columns, millimetres).
struct Template {
  Mat3 lattice;
  std::vector<Vec3> vertices;
  std::vector<EdgeTemplate> edges;
  std::vector<FaceTemplate> faces;
};

struct FaceInstance {
  std::uint32_t face = 0;
  Index3 cell{};
};

/// A closed oriented surface. `placement` is rigid or a uniform similarity and applies after the lattice translation.
/// `visit` calls back every face instance, always in the same order; it may be called from several threads.
struct Shell {
  std::shared_ptr<const Template> geometry;
  Affine placement;
  std::function<void(const std::function<void(const FaceInstance&)>&)> visit;
};

/// One solid: an outer shell and the voids inside it (their normals point into the void).
struct Solid {
  Shell outer;
  std::vector<Shell> voids;
};

struct Body {
  std::vector<Solid> solids;
  std::size_t fragments = 0;  ///< solids beyond the largest that a cut has left loose
};

}  // namespace meso::brep
