// SPDX-License-Identifier: Apache-2.0
#include "solid_beams.hpp"

#include <algorithm>
#include <numbers>

#include "meso/base/number.hpp"
#include "solid_primitive.hpp"

namespace meso::brep {
namespace {

struct Ball {
  Vec3 center;
  double radius;
};

/// Balls without repetition: struts that meet at a node bring the same cap.
class Balls {
 public:
  void add(Vec3 center, double radius) {
    const bool known = std::ranges::any_of(balls_, [&](const Ball& b) {
      return norm(b.center - center) <= smallest_size && radius <= b.radius + smallest_size;
    });
    if (known) return;
    std::erase_if(balls_, [&](const Ball& b) {
      return norm(b.center - center) <= smallest_size && b.radius <= radius + smallest_size;
    });
    balls_.push_back({center, radius});
  }
  [[nodiscard]] const std::vector<Ball>& all() const { return balls_; }

 private:
  std::vector<Ball> balls_;
};

bool is_size(double value) { return value > smallest_size && value < largest_size; }

bool refuse(std::string name, double value, ElementId where, const SolidContext& context) {
  context.report(Code::geometry_size, where, {std::move(name), format_number(value)});
  return false;
}

bool sizes_hold(const eval::Strut& strut, Vec3 from, double length, ElementId where, const SolidContext& context) {
  if (!is_size(length)) return refuse(size_of_beam_at("length", from), length, where, context);
  for (const double radius : {strut.radius_from, strut.radius_to})
    if (!is_size(radius)) return refuse(size_of_beam_at("radius", from), radius, where, context);
  return true;
}

bool is_cone(const eval::Strut& strut) { return std::fabs(strut.radius_from - strut.radius_to) > smallest_size; }

/// The half of a ball that looks along `outward_axis`.
TopoDS_Shape half_ball(Vec3 center, Vec3 outward_axis, double radius) {
  return BRepPrimAPI_MakeSphere(gp_Ax2(to_pnt(center), to_dir(outward_axis)), radius, 0, std::numbers::pi / 2).Solid();
}

}  // namespace

std::string size_of_beam_at(const char* what, Vec3 from) {
  const auto rounded = [](double mm) { return format_number(std::nearbyint(mm * 1e4) / 1e4); };
  return std::string("the ") + what + " of the beam at (" + rounded(from.x) + " " + rounded(from.y) + " " +
         rounded(from.z) + ") mm";
}

std::optional<Solids> beam_primitives(const eval::BeamsShape& beams, const Affine& map, ElementId where,
                                      const SolidContext& context) {
  Balls balls;
  Solids solids;
  for (const eval::StrutNode& node : beams.nodes) {
    if (!(norm(node.position) < largest_size)) {
      context.report(Code::geometry_size, where, {"the distance of a node from the origin", "more, or not a number"});
      return {};
    }
    if (node.ball_radius == 0) continue;
    if (!is_size(node.ball_radius)) {
      (void)refuse("the radius of a node", node.ball_radius, where, context);
      return {};
    }
    balls.add(node.position, node.ball_radius);
  }
  for (const eval::Strut& strut : beams.struts) {
    const Vec3 from = beams.nodes[strut.from].position, to = beams.nodes[strut.to].position;
    if (!sizes_hold(strut, from, norm(to - from), where, context)) return {};
    const Vec3 along = (to - from) / norm(to - from);
    solids.push_back(mapped(frustum(from, to, strut.radius_from, strut.radius_to), map));
    const auto add_cap = [&](BeamCap cap, Vec3 center, Vec3 outwards, double radius) {
      if (cap == BeamCap::butt) return;
      // Half a ball and a whole one differ only where the strut narrows away from it.
      if (cap == BeamCap::hemisphere && is_cone(strut))
        solids.push_back(mapped(half_ball(center, outwards, radius), map));
      else
        balls.add(center, radius);
    };
    add_cap(strut.cap_from, from, -along, strut.radius_from);
    add_cap(strut.cap_to, to, along, strut.radius_to);
  }
  for (const Ball& ball : balls.all())
    solids.push_back(mapped(BRepPrimAPI_MakeSphere(to_pnt(ball.center), ball.radius).Solid(), map));
  return solids;
}

}  // namespace meso::brep
