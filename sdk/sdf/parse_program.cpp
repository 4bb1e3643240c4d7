// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <set>

#include "arguments.hpp"
#include "meso/expr/nearest.hpp"
#include "meso/implicit/surfaces.hpp"
#include "meso/sdf/program.hpp"
#include "strut_cells.hpp"

namespace meso::sdf {
namespace {

constexpr std::string_view surface_prefix = "tpms.", strut_prefix = "strut.";

/// What other programs call our words.
struct Synonym {
  std::string_view theirs, ours;
};
constexpr Synonym synonyms[] = {{"sphere", "ball"},
                                {"cube", "box"},
                                {"cuboid", "box"},
                                {"tube", "cylinder"},
                                {"plane", "half-space"},
                                {"halfspace", "half-space"},
                                {"formula", "expression"},
                                {"function", "expression"},
                                {"mesh", "file"},
                                {"import", "file"},
                                {"load", "file"},
                                {"not", "complement"},
                                {"invert", "complement"},
                                {"negate", "complement"},
                                {"inverse", "complement"},
                                {"thicken", "offset"},
                                {"grow", "offset"},
                                {"dilate", "offset"},
                                {"erode", "offset"},
                                {"hollow", "shell"},
                                {"sheet", "shell"},
                                {"translate", "move"},
                                {"shift", "move"},
                                {"resize", "scale"},
                                {"turn", "rotate"},
                                {"align", "orient"},
                                {"reflect", "mirror"},
                                {"flip", "mirror"},
                                {"add", "union"},
                                {"join", "union"},
                                {"or", "union"},
                                {"merge", "union"},
                                {"and", "intersection"},
                                {"intersect", "intersection"},
                                {"subtract", "difference"},
                                {"minus", "difference"},
                                {"cut", "difference"},
                                {"primitive", "tpms.p"},
                                {"schwarz", "tpms.p"},
                                {"mix", "blend"},
                                {"lerp", "blend"},
                                {"fillet", "smooth-union"},
                                {"smooth", "smooth-union"},
                                {"fraction", "density"},
                                {"tile", "repeat"},
                                {"array", "repeat"},
                                {"polar", "cylindrical"},
                                {"helical", "helix"},
                                {"screw", "helix"},
                                {"spring", "helix"},
                                {"duplicate", "dup"},
                                {"copy", "dup"},
                                {"exchange", "swap"},
                                {"pop", "drop"},
                                {"discard", "drop"},
                                {"define", "def"},
                                {"name", "def"},
                                {"use", "recall"},
                                {"--samples", "-s"},
                                {"-n", "-s"},
                                {"--spacing", "-s"},
                                {"--bounds", "-b"},
                                {"--box", "-b"},
                                {"--output", "-o"}};

std::string solids(std::size_t n) { return std::to_string(n) + (n == 1 ? " solid" : " solids"); }

/// Words one after the other, files opened where they are included.
class WordStream {
 public:
  explicit WordStream(std::vector<Word> words) { open_.push_back({.words = std::move(words)}); }

  /// Null behind the last word.
  const Word* next() {
    while (open_.back().next == open_.back().words.size()) {
      if (open_.size() == 1) return nullptr;
      open_.pop_back();
    }
    ++read_;
    return &open_.back().words[open_.back().next++];
  }
  void include(std::string path, std::vector<Word> words) {
    open_.push_back({.path = std::move(path), .words = std::move(words)});
  }
  [[nodiscard]] std::string directory() const {
    return std::filesystem::path(open_.back().path).parent_path().string();
  }
  [[nodiscard]] bool is_open(const std::string& path) const {
    return std::any_of(open_.begin() + 1, open_.end(), [&](const Open& o) { return o.path == path; });
  }
  [[nodiscard]] std::size_t depth() const { return open_.size() - 1; }
  [[nodiscard]] std::size_t words_read() const { return read_; }

 private:
  struct Open {
    std::string path{};
    std::vector<Word> words{};
    std::size_t next = 0;
  };
  std::vector<Open> open_;
  std::size_t read_ = 0;
};

class ProgramParser {
 public:
  ProgramParser(std::vector<Word> words, const ProgramOptions& options, DiagnosticSink& sink)
      : stream_(std::move(words)), options_(options), sink_(sink) {}

  std::optional<Program> parse() {
    while (const Word* next = stream_.next()) {
      const Word word = *next;  // arguments and files move what stands in the stream
      if (!item(word)) return std::nullopt;
      if (program_.asks != Program::Asks::mesh) return std::move(program_);
    }
    if (depth_ == 1) return std::move(program_);
    Diagnostic d{.code = Code::sdf_stack_left, .args = {solids(depth_)}};
    if (!program_.instructions.empty()) point_at(d, program_.instructions.back().word);
    sink_.report(std::move(d));
    return std::nullopt;
  }

 private:
  bool item(const Word& word) {
    if (stream_.words_read() > max_words)
      return fail(word, Code::sdf_include, {"the program has more than " + std::to_string(max_words) + " words"});
    if (word.text.starts_with('@') && word.text.size() > 1) return include(word);
    if (const Vocable* vocable = find_vocable(word.text)) return instruction(*vocable, word);
    if (word.text.starts_with(surface_prefix)) return surface(word);
    if (word.text.starts_with(strut_prefix)) return strut(word);
    if (word.text.starts_with('-') && word.text.size() > 1) return option(word);
    return unknown(word);
  }

  bool instruction(const Vocable& vocable, const Word& word) {
    if (vocable.takes > depth_) return fail(word, Code::sdf_stack_underflow, {word.text, solids(vocable.takes)});
    Instruction made{.verb = vocable.verb, .word = word, .depth = depth_};
    if (!arguments(vocable, word, made)) return false;
    if (const std::string fault = fault_of(made); !fault.empty())
      return fail(word, Code::sdf_value, {word.text, fault});
    depth_ = depth_ - vocable.takes + vocable.puts;
    program_.instructions.push_back(std::move(made));
    return true;
  }

  bool arguments(const Vocable& vocable, const Word& word, Instruction& made) {
    switch (vocable.follows) {
      case Follows::nothing:
        return true;
      case Follows::numbers:
        return numbers(word, vocable.count, vocable.argument, made.numbers);
      case Follows::graded:
        return numbers_or_formulas(word, vocable, made);
      case Follows::one_or_three: {
        const auto given = number_list(word, {1, 3}, vocable.argument);
        if (!given) return false;
        for (std::size_t i = 0; i < 3; ++i) made.numbers[i] = given->size() == 1 ? (*given)[0] : (*given)[i];
        return true;
      }
      case Follows::vector_and_number: {
        std::array<double, 7> angle{};
        if (!numbers(word, 3, "x,y,z", made.numbers) || !numbers(word, 1, "an angle", angle, Measure::angle))
          return false;
        made.numbers[3] = angle[0];
        return true;
      }
      case Follows::formula: {
        const Word* text = argument(word, "a formula of x, y and z");
        if (text == nullptr) return false;
        const auto fault = formula_fault(text->text);
        if (fault) return fail(*text, Code::sdf_argument, {text->text, "a formula of x, y and z", fault->why}, *fault);
        made.text = text->text;
        return true;
      }
      case Follows::path: {
        const Word* text = argument(word, "the path of a mesh");
        if (text == nullptr) return false;
        made.text = text->text;
        return true;
      }
      case Follows::name:
        return name(word, made);
    }
    return false;
  }

  /// Of x, y and z where a list of constants cannot be read as one.
  bool numbers_or_formulas(const Word& word, const Vocable& vocable, Instruction& made) {
    const Word* given = argument(word, vocable.argument);
    if (given == nullptr) return false;
    const Word text = *given;
    const Measure measure = vocable.verb == Verb::density ? Measure::number : Measure::length;
    const auto read = read_numbers(text.text, {vocable.count}, measure);
    if (!read.fault) {
      std::copy(read.numbers.begin(), read.numbers.end(), made.numbers.begin());
      return true;
    }
    const auto fault = formulas_fault(text.text, vocable.count, measure);
    if (!fault) return made.text = text.text, true;
    return fail(text, Code::sdf_argument, {text.text, std::string(vocable.argument), fault->why}, *fault);
  }

  bool name(const Word& word, Instruction& made) {
    const Word* given = argument(word, "a name");
    if (given == nullptr) return false;
    const Word text = *given;
    if (text.text.empty()) return fail(text, Code::sdf_argument, {"", "a name", "it is empty"});
    if (made.verb == Verb::def) named_.insert(text.text);
    if (!named_.contains(text.text)) {
      std::vector<std::string_view> known(named_.begin(), named_.end());
      const std::string near(expr::nearest(text.text, known));
      return fail(
          text, Code::sdf_value,
          {word.text, "no solid is named '" + text.text + "'" +
                          (near.empty() ? "; def NAME gives the last one a name" : "; did you mean '" + near + "'?")});
    }
    made.text = text.text;
    return true;
  }

  bool surface(const Word& word) {
    const std::string_view name = std::string_view(word.text).substr(surface_prefix.size());
    if (!implicit::find_surface(name)) return unknown(word);
    program_.instructions.push_back({.verb = Verb::surface, .text = std::string(name), .word = word, .depth = depth_});
    ++depth_;
    return true;
  }

  bool strut(const Word& word) {
    const std::string_view name = std::string_view(word.text).substr(strut_prefix.size());
    if (!is_strut_cell(name)) return unknown(word);
    Instruction made{.verb = Verb::strut, .text = std::string(name), .word = word, .depth = depth_};
    if (!numbers(word, 1, "the radius of its struts, in edges of the cell", made.numbers)) return false;
    if (const std::string fault = fault_of(made); !fault.empty())
      return fail(word, Code::sdf_value, {word.text, fault});
    program_.instructions.push_back(std::move(made));
    ++depth_;
    return true;
  }

  bool option(const Word& word) {
    if (word.text == "-h" || word.text == "--help") return program_.asks = Program::Asks::help, true;
    if (word.text == "--version") return program_.asks = Program::Asks::version, true;
    if (word.text == "-b") return box(word);
    if (word.text == "-s") return samples(word);
    if (word.text == "-o") {
      const Word* path = argument(word, "the path of the output");
      if (path == nullptr) return false;
      if (path->text.empty()) return fail(*path, Code::sdf_argument, {"", "a path", "it is empty"});
      program_.output = path->text;
      return true;
    }
    return caller_flag(word);
  }

  bool box(const Word& word) {
    std::array<double, 7> n{};
    if (!numbers(word, 6, "x0,y0,z0,x1,y1,z1", n)) return false;
    for (std::size_t i = 0; i < 3; ++i) {
      if (n[i] < n[i + 3]) continue;
      return fail(last_, Code::sdf_value,
                  {word.text, "the box is empty or inverted along " + std::string(1, "xyz"[i])});
    }
    program_.box = Box3{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
    return true;
  }

  bool samples(const Word& word) {
    auto given = number_list(word, {1, 3}, "a number of samples, or three along the axes", Measure::number);
    if (!given) return false;
    for (double& n : *given) {
      const double whole = std::round(n);
      if (given->size() == 3 && std::abs(n - whole) <= 1e-9 * std::abs(n)) n = whole;
      if (!(n > 1)) return fail(last_, Code::sdf_value, {word.text, "there must be more than one sample"});
      if (given->size() == 3 && n != std::round(n))
        return fail(last_, Code::sdf_value, {word.text, "the number of samples along an axis must be whole"});
      if (given->size() == 3 && n > 2147483647)
        return fail(last_, Code::sdf_value, {word.text, "more than 2147483647 samples along an axis"});
    }
    program_.samples = std::move(*given);
    program_.has_samples = true;
    return true;
  }

  bool caller_flag(const Word& word) {
    const std::size_t equals = std::min(word.text.find('='), word.text.size());
    const std::string name = word.text.substr(0, equals);
    for (const CallerFlag& flag : options_.caller_flags) {
      if (flag.name != name) continue;
      if (equals < word.text.size() && !flag.takes_value)
        return fail(word, Code::sdf_argument, {word.text, "a flag", name + " takes no value"});
      GivenFlag given{.name = name};
      if (equals < word.text.size()) {
        given.value = word.text.substr(equals + 1);
      } else if (flag.takes_value) {
        const Word* value = argument(word, "a value");
        if (value == nullptr) return false;
        given.value = value->text;
      }
      program_.caller_flags.push_back(std::move(given));
      return true;
    }
    return unknown(word);
  }

  bool include(const Word& word) {
    const std::string path =
        (std::filesystem::path(stream_.directory()) / word.text.substr(1)).lexically_normal().string();
    if (!options_.read_text) return fail(word, Code::sdf_include, {"this program may not include files"});
    if (stream_.is_open(path)) return fail(word, Code::sdf_include, {"'" + path + "' includes itself"});
    if (stream_.depth() >= max_include_depth)
      return fail(word, Code::sdf_include, {"files include files deeper than " + std::to_string(max_include_depth)});
    auto read = options_.read_text(path);
    if (!read.text) return fail(word, Code::file_not_found, {path, read.why_not});
    auto words = words_of_text(std::move(*read.text), path, sink_);
    if (!words) return false;
    stream_.include(path, std::move(*words));
    return true;
  }

  bool unknown(const Word& word) {
    // A shell's quotation marks around all of them.
    if (const std::size_t space = word.text.find(' '); space != std::string::npos)
      if (const std::string first = word.text.substr(0, space); find_vocable(first) != nullptr)
        return fail(word, Code::sdf_unknown_word,
                    {word.text, "; leave out the quotation marks: each word is one argument"});
    const std::string misplaced = of_numbers_and_files(word.text);
    return fail(word, Code::sdf_unknown_word,
                {word.text, misplaced.empty() ? suggestion(nearest_word(word.text)) : misplaced});
  }

  /// `ball 5`, `torus 2 0.5`, `ball out.stl`: what stands where a word should.
  [[nodiscard]] std::string of_numbers_and_files(const std::string& text) const {
    for (const std::string_view mesh : {".ply", ".stl", ".3mf", ".obj", ".off", ".vtk", ".meso"})
      if (text.ends_with(mesh))
        return "; -o " + text + " writes it" + (mesh == ".meso" ? "" : ", file " + text + " reads it");
    if (program_.instructions.empty() || read_numbers(text, {1, 2, 3, 4, 6, 7}).fault) return "";
    const Instruction& before = program_.instructions.back();
    const Vocable* vocable = find_vocable(before.word.text);
    if (vocable == nullptr || (vocable->argument.empty() && vocable->takes == 0))
      return "; '" + before.word.text + "' takes no size: 'scale " + text + "' behind it scales it";
    if (vocable->argument.empty()) return "; '" + before.word.text + "' takes no number";
    return "; '" + before.word.text + "' takes " + std::string(vocable->argument) +
           ", separated by commas without spaces";
  }

  /// With what the word takes: who does not know its name does not know that either.
  static std::string suggestion(const std::string& near) {
    if (near.empty()) return "";
    if (near == "-s") return "; did you mean '-s'? Write: -s n, samples in all, or -s nx,ny,nz";
    const Vocable* vocable = find_vocable(near);
    const std::string meant = "; did you mean '" + near + "'?";
    if (vocable == nullptr || vocable->argument.empty()) return meant;
    return meant + " Write: " + near + " " + std::string(vocable->argument);
  }

  [[nodiscard]] std::string nearest_word(const std::string& word) const {
    for (const Synonym& s : synonyms)
      if (s.theirs == word) return std::string(s.ours);
    std::vector<std::string_view> known{"-b", "-s", "-o", "--help", "--version"};
    for (const Vocable& v : vocabulary()) known.push_back(v.word);
    for (const CallerFlag& flag : options_.caller_flags) known.push_back(flag.name);
    const std::vector<std::string> struts = strut_words();
    known.insert(known.end(), struts.begin(), struts.end());
    std::string near(expr::nearest(word, known));
    if (!near.empty()) return near;
    // Also a surface whose prefix is wrong or missing.
    near = implicit::nearest_surface(std::string_view(word).substr(word.find('.') + 1));  // npos + 1 is 0
    return near.empty() ? near : std::string(surface_prefix) + near;
  }

  /// The next word, whatever it looks like; null, with a diagnostic, if there is none.
  const Word* argument(const Word& of, std::string_view what) {
    if (const Word* word = stream_.next()) return &(last_ = *word);
    fail(of, Code::sdf_argument_missing, {of.text, std::string(what)});
    return nullptr;
  }

  bool numbers(const Word& of, std::size_t count, std::string_view what, std::array<double, 7>& out,
               Measure measure = Measure::length) {
    const auto given = number_list(of, {count}, what, measure);
    if (given) std::copy(given->begin(), given->end(), out.begin());
    return given.has_value();
  }

  std::optional<std::vector<double>> number_list(const Word& of, std::initializer_list<std::size_t> counts,
                                                 std::string_view what, Measure measure = Measure::length) {
    const Word* word = argument(of, what);
    if (word == nullptr) return std::nullopt;
    auto read = read_numbers(word->text, counts, measure);
    if (!read.fault) return std::move(read.numbers);
    fail(*word, Code::sdf_argument, {word->text, std::string(what), read.fault->why}, *read.fault);
    return std::nullopt;
  }

  bool fail(const Word& word, Code code, std::vector<std::string> args, const TextFault& fault = {}) {
    Diagnostic d{.code = code};
    if (code != Code::file_not_found) d.args = {std::to_string(word.number), std::to_string(depth_)};
    d.args.insert(d.args.end(), std::make_move_iterator(args.begin()), std::make_move_iterator(args.end()));
    point_at(d, word, fault.offset, fault.length);
    sink_.report(std::move(d));
    return false;
  }

  WordStream stream_;
  const ProgramOptions& options_;
  DiagnosticSink& sink_;
  Program program_;
  Word last_;  ///< read
  std::size_t depth_ = 0;
  std::set<std::string, std::less<>> named_;  ///< by def
};

}  // namespace

std::optional<Program> parse_program(std::vector<Word> words, const ProgramOptions& options, DiagnosticSink& sink) {
  return ProgramParser(std::move(words), options, sink).parse();
}

}  // namespace meso::sdf
