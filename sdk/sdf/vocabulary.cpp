// SPDX-License-Identifier: Apache-2.0
#include "meso/sdf/vocabulary.hpp"

#include <algorithm>

namespace meso::sdf {

std::span<const Vocable> vocabulary() {
  using enum Verb;
  using F = Follows;
  static constexpr Vocable table[] = {
      {"ball", ball, 0, 1, F::nothing, 0, "", "the ball of radius 1", false},
      {"cylinder", cylinder, 0, 1, F::nothing, 0, "", "the endless cylinder of radius 1 about the z axis", false},
      {"box", box, 0, 1, F::nothing, 0, "", "the cube from -1 to 1 along each axis", false},
      {"cone", cone, 0, 1, F::numbers, 3, "R,r,h", "about the z axis, radius R at z = 0 and r at z = h", true},
      {"torus", torus, 0, 1, F::numbers, 2, "R,r", "a torus about the z axis: ring of radius R, tube of radius r",
       true},
      {"capsule", capsule, 0, 1, F::numbers, 7, "x,y,z,x,y,z,r", "all points within r of a segment", true},
      {"half-space", half_space, 0, 1, F::numbers, 4, "nx,ny,nz,d",
       "all points whose product with the unit normal is at most d", true},
      {"expression", expression, 0, 1, F::formula, 0, "'F(x,y,z)'", "all points where a formula is negative", false},
      {"file", file, 0, 1, F::path, 0, "PATH", "the inside of a mesh: .ply .stl .obj .off", false},
      {"complement", complement, 1, 1, F::nothing, 0, "", "what is not in it", false},
      {"offset", offset, 1, 1, F::graded, 1, "d", "grown by d, shrunk by -d; a level, f - d", false},
      {"shell", shell, 1, 1, F::graded, 1, "t", "the wall of thickness t about its surface; |f| - t/2", false},
      {"eccentric-shell", eccentric_shell, 1, 1, F::graded, 2, "a,b", "the wall between the levels a < b", true},
      {"move", move, 1, 1, F::numbers, 3, "dx,dy,dz", "moved", false},
      {"scale", scale, 1, 1, F::one_or_three, 3, "k | kx,ky,kz", "scaled about the origin; negative factors mirror",
       false},
      {"rotate", rotate, 1, 1, F::vector_and_number, 4, "x,y,z a",
       "turned about an axis through the origin by a radians", false},
      {"orient", orient, 1, 1, F::numbers, 3, "x,y,z", "turned so that its z axis points there", false},
      {"mirror", mirror, 1, 1, F::numbers, 3, "nx,ny,nz", "mirrored in the plane through the origin with this normal",
       true},
      {"density", density, 1, 1, F::graded, 1, "s", "the level that fills this share of each period", true},
      {"repeat", repeat, 1, 1, F::numbers, 3, "dx,dy,dz",
       "what lies around the origin again at every step along the axes; 0: not along this one", true},
      {"cylindrical", cylindrical, 1, 1, F::numbers, 1, "n",
       "bent about the z axis: x becomes the radius, n units of y a turn", true},
      {"spherical", spherical, 1, 1, F::numbers, 2, "n,m",
       "bent about the origin: x becomes the radius, n units of y a turn, m of z from pole to pole", true},
      {"helix", helix, 1, 1, F::numbers, 2, "n,p", "wound about the z axis: as cylindrical, rising by p a turn", true},
      {"union", union_of, 2, 1, F::nothing, 0, "", "both together", false},
      {"intersection", intersection, 2, 1, F::nothing, 0, "", "what both share", false},
      {"difference", difference, 2, 1, F::nothing, 0, "", "the first without the second", false},
      {"smooth-union", smooth_union, 2, 1, F::numbers, 1, "r", "both together, a fillet of radius r where they meet",
       true},
      {"blend", blend, 2, 1, F::formula, 0, "'w(x,y,z)'", "the first where w is 0, the second where it is 1", true},
      {"dup", dup, 1, 2, F::nothing, 0, "", "the solid twice", true},
      {"swap", swap, 2, 2, F::nothing, 0, "", "both in the other order", true},
      {"drop", drop, 1, 0, F::nothing, 0, "", "without the last solid", true},
      {"over", over, 2, 3, F::nothing, 0, "", "both, and the first once more", true},
      {"def", def, 1, 0, F::name, 0, "NAME", "takes the solid away and gives it a name", true},
      {"recall", recall, 0, 1, F::name, 0, "NAME", "the solid of that name", true},
  };
  return table;
}

const Vocable* find_vocable(std::string_view word) {
  const auto all = vocabulary();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Vocable& v) { return v.word == word; });
  return found == all.end() ? nullptr : &*found;
}

namespace {
const Vocable* vocable_of(Verb verb) {
  const auto all = vocabulary();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Vocable& v) { return v.verb == verb; });
  return found == all.end() ? nullptr : &*found;
}
}  // namespace

std::string_view word_of(Verb verb) {
  const Vocable* vocable = vocable_of(verb);
  return vocable != nullptr ? vocable->word : verb == Verb::surface ? "tpms" : "strut";
}

std::size_t solids_taken(Verb verb) {
  const Vocable* vocable = vocable_of(verb);
  return vocable != nullptr ? vocable->takes : 0;
}

}  // namespace meso::sdf
