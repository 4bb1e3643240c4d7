// SPDX-License-Identifier: Apache-2.0
#pragma once
// What of very many primitives counts in a brick of samples, and samples of that. Private.
//
// What is farther than another thing is dropped, and what neighbouring cells both place is kept once: a sample costs
// the two or three struts near it.

#include <algorithm>
#include <span>
#include <vector>

#include "primitive.hpp"
#include "strut_rows.hpp"

namespace meso::implicit {

/// How far away things count.
struct Nearness {
  double margin = 0;      ///< values up to here are exact
  double far = 0;         ///< what stands where nothing is near
  bool is_exact = false;  ///< values count everywhere, deep inside too
};

/// A box around a brick's samples.
struct BrickBox {
  Vec3 middle, half;
  double radius = 0;  ///< |half|
};

struct Brick {
  enum class State : std::uint8_t { unknown, outside, inside, mixed };
  State state = State::unknown;
  std::uint32_t capsule = 0, capsules = 0, field = 0, fields = 0;
};

/// The contents of many bricks, one after the other.
class BrickContents {
 public:
  /// That the visit's call number `call` is why `thing` counts; several calls may place the same thing.
  struct Source {
    std::uint32_t thing, call;
  };

  void clear() {
    capsules_.clear();
    fields_.clear();
  }

  /// `visit(box, f)` calls f(primitive, displacement) for all that may meet the box.
  template <class Visit>
  Brick add(const BrickBox& brick, const Nearness& nearness, Visit visit) {
    begin(brick, nearness);
    const Vec3 by{nearness.margin, nearness.margin, nearness.margin};
    visit(Box3{box_.min - by, box_.max + by}, [&](const Primitive& p, Vec3 displacement) { look_at(p, displacement); });
    return finish();
  }

  [[nodiscard]] const Capsule* capsules(const Brick& b) const { return capsules_.data() + b.capsule; }
  [[nodiscard]] std::span<const PlacedField> fields(const Brick& b) const {
    return {fields_.data() + b.field, b.fields};
  }
  /// Of the brick that was added last: what must be there for it to be as it is.
  [[nodiscard]] std::span<const Source> sources() const { return sources_; }

 private:
  struct Candidate {
    Capsule capsule;
    double distance;  ///< of the brick's middle
    std::uint32_t call;
  };

  struct FieldCandidate {
    const Primitive* primitive;
    Vec3 displacement;
    double least;  ///< in the brick
    std::uint32_t call;
  };

  void begin(const BrickBox& brick, const Nearness& nearness);
  void look_at(const Primitive& primitive, Vec3 displacement);
  Brick finish();
  void keep_fields();
  void keep_capsules(std::size_t first);

  std::vector<Capsule> capsules_;
  std::vector<PlacedField> fields_;
  // Of the brick at hand.
  BrickBox brick_;
  Box3 box_;
  Nearness nearness_;
  std::uint32_t calls_ = 0;
  double nearest_ = 0;   ///< of the capsules, to the brick's middle
  double farthest_ = 0;  ///< nowhere in the brick is the least value more
  std::vector<Candidate> candidates_;
  std::vector<FieldCandidate> field_candidates_;
  std::vector<Source> sources_;
};

/// Rows of a brick, strut_lanes samples each. What is neither strut nor ball is asked at all of them at once: a formula
/// costs a fraction for many points of what it costs for few.
class BrickSampler {
 public:
  explicit BrickSampler(const Nearness& nearness) : row_(strut_row()), far_(nearness.far) {}
  void sample(const BrickContents& contents, const Brick& brick, std::span<const Line> lines, const double* x,
              double* out);

 private:
  StrutRow row_;
  double far_;
  std::vector<Vec3> points_, local_;
  std::vector<double> values_;
};

}  // namespace meso::implicit
