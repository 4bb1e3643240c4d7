// SPDX-License-Identifier: Apache-2.0
#pragma once
// What faces enclose, from their moments. Private.

#include "meso/brep/body.hpp"

namespace meso::brep {

/// Adds up faces and tells the volume about the middle of all of them, where it counts for least what edges lack that
/// are known to 1e-7 mm only.
class Enclosed {
 public:
  /// `face`, moved by `offset`.
  void add(const FaceTemplate& face, Vec3 offset) {
    const FaceMoments& m = face.moments;
    for (std::size_t i = 0; i < 3; ++i) moment_ += m.volume_moment[i] + offset[i] * m.vector_area[i];
    area_ += m.vector_area;
    box_.extend(face.box.min + offset);
    box_.extend(face.box.max + offset);
    count_ += 1;
  }
  void add(const Enclosed& other) {
    if (other.empty()) return;
    moment_ += other.moment_;
    area_ += other.area_;
    box_.extend(other.box_.min);
    box_.extend(other.box_.max);
    count_ += other.count_;
  }
  [[nodiscard]] bool empty() const { return count_ == 0; }
  /// Less than 0: the faces look into a hollow.
  [[nodiscard]] double volume() const { return empty() ? 0 : (moment_ - dot(0.5 * (box_.min + box_.max), area_)) / 3; }

 private:
  double moment_ = 0;  ///< three times the volume, about the origin
  Vec3 area_;
  Box3 box_;
  std::size_t count_ = 0;
};

}  // namespace meso::brep
