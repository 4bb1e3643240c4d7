// SPDX-License-Identifier: Apache-2.0
#pragma once
// Does a body keep clear of a face, or of another body? Proven from a coarse triangulation and the signed distance of
// the face's unbounded surface; what that cannot prove is left to OpenCASCADE's exact distance. Private.

#include <optional>

#include "ellipsoid.hpp"
#include "meso/brep/body.hpp"
#include "solid_context.hpp"

namespace meso::brep {

/// Bodies closer than this touch (millimetres).
inline constexpr double clear_distance = 1e-5;

/// The surface that carries a face, unbounded.
class CarrierSurface {
 public:
  explicit CarrierSurface(const TopoDS_Face& face);

  [[nodiscard]] const TopoDS_Face& face() const { return face_; }
  [[nodiscard]] const Box3& box() const { return box_; }
  /// At most the distance from the surface, with a sign that is constant on each side; at most the distance to the
  /// face's box where the surface has no formula. A change of p by d changes it by d at most.
  [[nodiscard]] double signed_distance(Vec3 p) const;
  /// True if signed_distance is a convex function on the triangle of these points.
  [[nodiscard]] bool is_convex_on(const std::array<Vec3, 3>& points) const;
  /// Of signed_distance, where that is convex.
  [[nodiscard]] Vec3 gradient(Vec3 p) const;
  /// True for the whole surface of a sphere or ellipsoid: signed_distance < 0 is then what it encloses.
  [[nodiscard]] bool is_closed() const { return is_closed_; }
  [[nodiscard]] bool is_plane() const { return type_ == GeomAbs_Plane; }

 private:
  void be(const Ellipsoid& ellipsoid);

  TopoDS_Face face_;
  Box3 box_;
  GeomAbs_SurfaceType type_ = GeomAbs_OtherSurface;
  bool is_closed_ = false;
  Vec3 origin_, axis_{0, 0, 1};
  double radius_ = 0, minor_ = 0, sine_ = 0, cosine_ = 1;
  std::optional<Mat3> ball_from_ellipsoid_;  ///< linear part; `minor_` is then the shortest half axis
};

/// Triangles near a body's surface: no point of it is farther than `error` from them. None, and an infinite error,
/// where OpenCASCADE finds none: nothing is proven then.
struct CoarseMesh {
  std::vector<Vec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  double error = 0;

  [[nodiscard]] CoarseMesh placed(const Affine& placement) const;
};
/// `fineness` scales the error: a hundredth of the body's diagonal at 1.
[[nodiscard]] CoarseMesh coarse_mesh(const Solids& solids, double fineness = 1);

/// +1 or -1: all of the body lies on that side of the surface, farther than `gap`; 0: not proven.
[[nodiscard]] int proven_side(const CarrierSurface& surface, const CoarseMesh& mesh, double gap);
/// True if two bodies are proven to be farther apart than clear_distance: a face of the first lies between them.
/// `surfaces` are of the first body, all in one frame.
[[nodiscard]] bool proven_apart(const std::vector<CarrierSurface>& surfaces, const CoarseMesh& first,
                                const CoarseMesh& second);

/// By OpenCASCADE, exact; 0 where one is inside the other. Throws Standard_Failure.
[[nodiscard]] double exact_distance(const TopoDS_Shape& a, const TopoDS_Shape& b);

}  // namespace meso::brep
