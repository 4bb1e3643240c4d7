// SPDX-License-Identifier: Apache-2.0
#include "meso/brep/measure.hpp"

#include "meso/brep/placement.hpp"

namespace meso::brep {
namespace {

// Wide sums: a lattice adds a million terms whose leading digits cancel.
struct Sum3 {
  long double x = 0, y = 0, z = 0;
  void add(double dx, double dy, double dz) {
    x += dx;
    y += dy;
    z += dz;
  }
  [[nodiscard]] Vec3 value() const { return {static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)}; }
};

struct ShellMoments {
  long double area = 0;
  Sum3 volume, centroid, vector_area;
  std::uint64_t faces = 0;

  // p -> p + t turns p_i n_i into itself + t_i n_i, and p_i^2/2 n_i into itself + t_i p_i n_i + t_i^2/2 n_i.
  void add(const FaceMoments& m, Vec3 t) {
    area += m.area;
    const Vec3 &v = m.volume_moment, &a = m.vector_area, &c = m.centroid_moment;
    volume.add(v.x + t.x * a.x, v.y + t.y * a.y, v.z + t.z * a.z);
    vector_area.add(a.x, a.y, a.z);
    centroid.add(c.x + t.x * (v.x + t.x / 2 * a.x), c.y + t.y * (v.y + t.y / 2 * a.y),
                 c.z + t.z * (v.z + t.z / 2 * a.z));
    ++faces;
  }
};

Box3 placed_box(const Box3& box, const Affine& placement) {
  Box3 out;
  for (int corner = 0; corner < 8; ++corner)
    out.extend(placement * Vec3{(corner & 1 ? box.max : box.min).x, (corner & 2 ? box.max : box.min).y,
                                (corner & 4 ? box.max : box.min).z});
  return out;
}

Box3 translated(const Box3& box, Vec3 t) { return {box.min + t, box.max + t}; }

}  // namespace

Measures measure(const Body& body) {
  Measures total;
  Vec3 first_moment;
  const auto add_shell = [&](const Shell& shell) {
    const Template& geometry = *shell.geometry;
    ShellMoments moments;
    Box3 box;
    shell.visit([&](const FaceInstance& instance) {
      const FaceTemplate& face = geometry.faces[instance.face];
      const Vec3 t = cell_origin(geometry, instance.cell);
      moments.add(face.moments, t);
      const Box3 moved = translated(face.box, t);
      box.extend(moved.min);
      box.extend(moved.max);
    });
    const double scale = std::cbrt(determinant(shell.placement.linear));
    // About the shell's middle: what faces do not close by counts for no more where the shell is far from the origin.
    const Vec3 v = moments.volume.value();
    const double volume = (v.x + v.y + v.z - dot(0.5 * (box.min + box.max), moments.vector_area.value())) / 3;
    // The centroid of the shell alone is volume-weighted before it is placed: placement * (m / v) * v s^3.
    total.volume += volume * scale * scale * scale;
    total.area += static_cast<double>(moments.area) * scale * scale;
    first_moment += scale * scale * scale *
                    (shell.placement.linear * moments.centroid.value() + volume * shell.placement.translation);
    total.faces += moments.faces;
    ++total.shells;
    return placed_box(box, shell.placement);
  };
  for (const Solid& solid : body.solids) {
    const Box3 box = add_shell(solid.outer);
    total.box.extend(box.min);
    total.box.extend(box.max);
    for (const Shell& hollow : solid.voids) (void)add_shell(hollow);
    ++total.solids;
  }
  if (total.volume != 0) total.centroid = first_moment / total.volume;
  return total;
}

}  // namespace meso::brep
