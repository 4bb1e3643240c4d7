// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where the viewer stands, so that every point of the mesh is in the picture and the picture is full.

#include <vector>

#include "meso/base/vec.hpp"
#include "meso/render/picture.hpp"

namespace meso::picture {

[[nodiscard]] inline Vec3 normalized(Vec3 v) { return v / norm(v); }

/// Right-handed unit vectors of the picture: `right` and `up` span it, `back` points to the viewer.
/// `vertical` is the world's up, which lights the scene.
struct View {
  Vec3 right, up, back, vertical;
};
[[nodiscard]] View view_for(const RenderOptions& options, const Box3& bounds);

class Camera {
 public:
  /// Fits exactly: the tightest distance at which all points are inside the frame less its margin, centred.
  Camera(const View& view, const std::vector<Vec3>& points, std::uint32_t width, std::uint32_t height);

  [[nodiscard]] Vec3 position() const { return position_; }
  /// Unit direction of the ray through pixel coordinates (0,0 is the top left corner of the top left pixel).
  [[nodiscard]] Vec3 ray(double x, double y) const;

 private:
  View view_;
  Vec3 position_;
  double width_, height_;
  double tan_x_ = 0, tan_y_ = 0;  ///< half the picture, as seen from distance 1
};

}  // namespace meso::picture
