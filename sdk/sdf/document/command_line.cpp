// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "meso/base/number.hpp"
#include "meso/sdf_document/words_and_documents.hpp"

namespace meso::sdf {
namespace {

std::string list(const double* first, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += (i > 0 ? "," : "") + format_number(first[i]);
  return text;
}

std::string quoted(const std::string& text) {
  constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./,+:@%=-";
  if (!text.empty() && text.find_first_not_of(plain) == std::string::npos) return text;
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

std::string words_of(const Instruction& instruction) {
  const auto& n = instruction.numbers;
  const std::string word(word_of(instruction.verb));
  if (instruction.verb == Verb::surface) return word + "." + instruction.text;
  if (instruction.verb == Verb::strut) return word + "." + instruction.text + " " + format_number(n[0]);
  if (!instruction.text.empty()) return word + " " + quoted(instruction.text);
  const Vocable& vocable = *find_vocable(word);
  switch (vocable.follows) {
    case Follows::numbers:
    case Follows::graded:
      return word + " " + list(n.data(), vocable.count);
    case Follows::one_or_three:
      return word + " " + list(n.data(), n[0] == n[1] && n[1] == n[2] ? 1 : 3);
    case Follows::vector_and_number:
      return word + " " + list(n.data(), 3) + " " + format_number(n[3]);
    default:
      return word;
  }
}

/// Corners whose difference gives the size again that the box was made of: the upper one may be a step beside it.
std::string corners(const Box3& box) {
  Vec3 upper = box.max;
  for (std::size_t a = 0; a < 3; ++a) {
    double below = upper[a], above = upper[a];
    for (int step = 0; step < 8 && box.min[a] + (upper[a] - box.min[a]) != box.max[a]; ++step) {
      below = std::nextafter(below, -HUGE_VAL), above = std::nextafter(above, HUGE_VAL);
      upper[a] = box.min[a] + (below - box.min[a]) == box.max[a] ? below : above;
    }
  }
  const double numbers[] = {box.min.x, box.min.y, box.min.z, upper.x, upper.y, upper.z};
  return list(numbers, 6);
}

}  // namespace

std::string command_line(const Program& program) {
  std::string line;
  for (const Instruction& instruction : program.instructions) line += words_of(instruction) + " ";
  if (program.box) line += "-b " + corners(*program.box) + " ";
  return line + "-s " + list(program.samples.data(), program.samples.size());
}

}  // namespace meso::sdf
