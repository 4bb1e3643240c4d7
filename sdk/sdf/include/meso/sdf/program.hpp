// SPDX-License-Identifier: Apache-2.0
#pragma once
// A program in the Cesogen language, read and checked, nothing of it carried out: docs/sdf.md is the language.
//
//   const std::vector<std::string> arguments{"-s", "60^3", "tpms.gyroid", "offset", "-.2", "-o", "g.stl"};
//   DiagnosticSink sink;
//   const auto program = sdf::parse_program(sdf::words_of_arguments(arguments), {}, sink);
//   // program->output == "g.stl", program->samples[0] == 216000, program->instructions has two entries
//
// Numbers are constant expressions (docs/specification/expressions.md, with `tau`), those of offset, shell,
// eccentric-shell and density also expressions of x, y, z; lengths in millimetres, angles in radians. Every fault is
// one SDF_* diagnostic that names the word, draws a caret, and tells how many solids the stack holds there; reading
// stops at the first. Thread rule: programs are values.

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "meso/base/vec.hpp"
#include "meso/sdf/vocabulary.hpp"
#include "meso/sdf/words.hpp"

namespace meso::sdf {

/// One word that changes the stack, its arguments, and where it stands.
struct Instruction {
  Verb verb{};
  std::array<double, 7> numbers{};  ///< as many as the word takes; of `scale k`, three times k
  /// Of `expression`, `blend`, `file`, `def`, `recall`; the surface of `tpms.`, the cell of `strut.`; of a word whose
  /// numbers differ from point to point, these, separated by commas.
  std::string text{};
  Word word{};
  std::size_t depth = 0;  ///< solids on the stack before it
};

/// A flag that only the caller understands, such as --json.
struct CallerFlag {
  std::string name;
  bool takes_value = false;
};
struct GivenFlag {
  std::string name;
  std::string value;
};

struct Program {
  std::vector<Instruction> instructions;
  std::optional<Box3> box;                                    ///< -b; absent: the solid's own
  std::vector<double> samples{1e6};                           ///< -s: one number in all, or three along the axes
  bool has_samples = false;                                   ///< -s was given
  std::string output = "out.ply";                             ///< -o
  std::vector<GivenFlag> caller_flags;                        ///< in order; the last of equals is meant
  enum class Asks { mesh, help, version } asks = Asks::mesh;  ///< help and version: the rest was not read
};

struct ProgramOptions {
  std::span<const CallerFlag> caller_flags{};
  /// The text of an @file, or a reason why there is none. Absent: programs that include others are refused.
  struct Text {
    std::optional<std::string> text;
    std::string why_not{};
  };
  std::function<Text(const std::string& path)> read_text{};
};

[[nodiscard]] std::optional<Program> parse_program(std::vector<Word> words, const ProgramOptions& options,
                                                   DiagnosticSink& sink);

inline constexpr std::size_t max_include_depth = 32;
inline constexpr std::size_t max_words = 100'000;  ///< a program's, includes counted as often as they occur

}  // namespace meso::sdf
