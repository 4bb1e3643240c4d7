// SPDX-License-Identifier: Apache-2.0
#include "meso/brep/triangles.hpp"

#include "meso/brep/instance_map.hpp"
#include "meso/brep/placement.hpp"

namespace meso::brep {

namespace {

/// The triangles of one face instance at a time.
class Instances {
 public:
  Instances(const Shell& shell, const TriangleBlockCallback& callback) : shell_(shell), callback_(callback) {}

  void visit(const FaceInstance& instance) {
    const Template& geometry = *shell_.geometry;
    const Triangulation& mesh = geometry.faces[instance.face].mesh;
    points_.clear();
    block_.clear();
    // Integers are added before anything is rounded: two faces that name a point from two cells get the same bits.
    for (const MeshPoint& p : mesh.points)
      points_.push_back(shell_.placement * (p.point + cell_origin(geometry, instance.cell + p.offset)));
    for (const auto& t : mesh.triangles) block_.push_back({points_[t[0]], points_[t[1]], points_[t[2]]});
    callback_(block_);
  }

 private:
  const Shell& shell_;
  const TriangleBlockCallback& callback_;
  std::vector<Vec3> points_;
  std::vector<Triangle> block_;
};

template <typename Visit>
void visit_shells(const Body& body, Visit visit) {
  for (const Solid& solid : body.solids) {
    visit(solid.outer);
    for (const Shell& hollow : solid.voids) visit(hollow);
  }
}

struct ShellFaces {
  const Shell* shell;
  std::vector<FaceInstance> faces;
};
/// Faces of one shell, and of those behind it up to the next range.
struct Range {
  std::size_t shell = 0, face = 0;
};

}  // namespace

void visit_triangles(const Body& body, const TriangleBlockCallback& callback) {
  visit_shells(body, [&](const Shell& shell) {
    Instances instances(shell, callback);
    shell.visit([&](const FaceInstance& instance) { instances.visit(instance); });
  });
}

TriangleStream triangles_of(const Body& body) {
  return [&body](const TriangleBlockCallback& callback) { visit_triangles(body, callback); };
}

TriangleRanges triangle_ranges(const Body& body) {
  constexpr std::size_t range_triangles = 20'000;
  const auto shells = std::make_shared<std::vector<ShellFaces>>();
  const auto ranges = std::make_shared<std::vector<Range>>();
  std::size_t triangles = range_triangles;
  visit_shells(body, [&](const Shell& shell) {
    std::vector<FaceInstance>& faces = shells->emplace_back(&shell).faces;
    shell.visit([&](const FaceInstance& instance) {
      if (triangles >= range_triangles) {
        ranges->push_back({shells->size() - 1, faces.size()});
        triangles = 0;
      }
      triangles += shell.geometry->faces[instance.face].mesh.triangles.size();
      faces.push_back(instance);
    });
  });
  return {ranges->size(), [shells, ranges](std::size_t range, const TriangleBlockCallback& callback) {
            const Range begin = (*ranges)[range];
            const Range end = range + 1 < ranges->size() ? (*ranges)[range + 1] : Range{shells->size(), 0};
            for (std::size_t s = begin.shell; s < shells->size() && s <= end.shell; ++s) {
              const ShellFaces& shell = (*shells)[s];
              Instances instances(*shell.shell, callback);
              const std::size_t last = s == end.shell ? end.face : shell.faces.size();
              for (std::size_t f = s == begin.shell ? begin.face : 0; f < last; ++f) instances.visit(shell.faces[f]);
            }
          }};
}

}  // namespace meso::brep
