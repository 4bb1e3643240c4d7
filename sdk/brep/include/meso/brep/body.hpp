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

// Surface normals, before `reversed`: a plane's is z; cylinder, cone, sphere and torus point away from their axis,
// centre or tube; a B-spline's is du x dv.

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

/// An edge modulo lattice translation: its curve from vertex 0 to vertex 1, in the curve's direction. A closed edge has
/// the same vertex and offset twice. A B-spline curve ends where its edge ends (it is never trimmed by the vertices).
/// Vertex k of the edge lies in the cell (edge's cell) + vertex_offset[k].
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

/// Integrals over the exact face, n the outward normal, about the template's origin; i = x, y, z. By the divergence
/// theorem the sums over a closed shell are its area, its volume (each component of volume_moment is one), zero, and
/// the volume times the centroid. Those of an instance translated by t follow without integrating again.
struct FaceMoments {
  double area = 0;       ///< integral of dA
  Vec3 volume_moment;    ///< integral of p_i n_i dA
  Vec3 vector_area;      ///< integral of n_i dA
  Vec3 centroid_moment;  ///< integral of p_i^2 / 2 n_i dA
};

/// A face modulo lattice translation.
struct FaceTemplate {
  Surface surface;
  bool reversed = false;                   ///< outward is against the surface's own normal
  std::vector<std::vector<Coedge>> loops;  ///< counter-clockwise about the outward normal (after `reversed`), so two
                                           ///< faces use a common edge in opposite directions; outer loop first
  FaceMoments moments;
  Box3 box;            ///< contains the exact face
  Triangulation mesh;  ///< filled only when a mesh was asked for
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
  /// What the pieces hold that the body was put together from, each integrated on its own before that: cells, or a body
  /// and its voids. The shells must enclose as much. 0: not known.
  double pieces_volume = 0;
};

}  // namespace meso::brep
