// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <numbers>

#include "meso/sdf/program.hpp"

namespace meso::sdf {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using Files = std::map<std::string, std::string>;

/// A command line as a shell would split it.
std::vector<std::string> shell_words(const std::string& line) {
  DiagnosticSink sink;
  std::vector<std::string> out;
  const auto words = words_of_text(line, "line", sink);
  for (const Word& word : *words) out.push_back(word.text);
  return out;
}

struct Parsed {
  std::optional<Program> program;
  DiagnosticSink sink;

  [[nodiscard]] Code code() const {
    return sink.diagnostics().size() == 1 ? sink.diagnostics()[0].code : Code::internal;
  }
  [[nodiscard]] std::string text() const {
    return sink.diagnostics().empty() ? "no diagnostic" : render(sink.diagnostics()[0]);
  }
};

Parsed parse(const std::string& line, const Files& files = {}, std::vector<CallerFlag> flags = {}) {
  Parsed out;
  const std::vector<std::string> words = shell_words(line);
  ProgramOptions options{.caller_flags = flags, .read_text = [&](const std::string& path) -> ProgramOptions::Text {
                           const auto found = files.find(path);
                           if (found == files.end()) return {.why_not = "it is not there"};
                           return {.text = found->second};
                         }};
  out.program = parse_program(words_of_arguments(words), options, out.sink);
  return out;
}

std::string verbs(const Parsed& parsed) {
  std::string out;
  if (!parsed.program) return parsed.text();
  for (const Instruction& i : parsed.program->instructions) out += (out.empty() ? "" : " ") + i.word.text;
  return out;
}

TEST(Language, CommandsOfThePaperAreWellFormed) {
  for (const char* line :
       {"-s 60^3 tpms.gyroid -o x.ply", "-s 60^3 tpms.p offset 0.35", "-s 60^3 tpms.p shell 0.7",
        "tpms.gyroid offset 0.25 complement", "tpms.gyroid offset 0.25 shell 0.5", "expression 'x+y+z-1'",
        "tpms.gyroid scale 1.3 file baluster.obj intersection",
        "-s 40^3 cylinder move 0,-2,0 cylinder move 0,2,0 union scale 1/2 orient 1,0,0 complement box intersection",
        "-b -4,-4,-4,4,4,4 -s 130^3 ball scale 5 tpms.p scale 4 tpms.d scale 3.75 tpms.gyroid scale 1.25 intersection "
        "intersection "
        "intersection",
        "-b -4,-4,-4,4,4,4 -s 100^3 ball scale 4 tpms.gyroid scale 4 intersection",
        "tpms.gyroid file mesh1.ply intersection tpms.p file mesh2.ply intersection union",
        "cylinder orient 1,0,0 scale 1/2", "ball shell 0.2", "ball scale 1,2,3", "box rotate 0,0,1 pi/4",
        "expression 'cos(2*pi*x) + cos(2*pi*y) + cos(2*pi*z)'"}) {
    EXPECT_EQ(parse(line).text(), "no diagnostic") << line;
  }
}

TEST(Language, WordsTakeWhatFollowsVerbatim) {
  const Parsed p = parse("ball move -1,0,0 offset -.2 -b -4,-3,-2,4,3,2 -o -h");
  ASSERT_TRUE(p.program) << p.text();
  EXPECT_EQ(p.program->instructions[1].numbers[0], -1);
  EXPECT_EQ(p.program->instructions[2].numbers[0], -0.2);
  EXPECT_EQ(p.program->box, (Box3{{-4, -3, -2}, {4, 3, 2}}));
  EXPECT_EQ(p.program->output, "-h");
  EXPECT_EQ(p.program->asks, Program::Asks::mesh);
}

TEST(Language, Defaults) {
  const Parsed p = parse("ball");
  ASSERT_TRUE(p.program);
  EXPECT_EQ(p.program->output, "out.ply");
  EXPECT_THAT(p.program->samples, ElementsAre(1e6));
  EXPECT_FALSE(p.program->box);
}

TEST(Language, OptionsStandAnywhereAndTheLastWins) {
  const Parsed p = parse("-s 8 ball -o a.ply -s 10,20,30 complement -o b.stl -b 0,0,0,1,1,1 --json --jobs 3 --jobs=4",
                         {}, {{"--json", false}, {"--jobs", true}});
  ASSERT_TRUE(p.program) << p.text();
  EXPECT_EQ(p.program->output, "b.stl");
  EXPECT_THAT(p.program->samples, ElementsAre(10, 20, 30));
  ASSERT_EQ(p.program->caller_flags.size(), 3u);
  EXPECT_EQ(p.program->caller_flags[0].name, "--json");
  EXPECT_EQ(p.program->caller_flags[1].value, "3");
  EXPECT_EQ(p.program->caller_flags[2].value, "4");
  EXPECT_EQ(parse("ball nonsense -h").code(), Code::sdf_unknown_word);
  EXPECT_EQ(parse("ball -h nonsense").program->asks, Program::Asks::help);
  EXPECT_EQ(parse("--version").program->asks, Program::Asks::version);
}

TEST(Language, NumbersAreConstantExpressions) {
  const Parsed p = parse("ball scale max(1,2),40^3,-1/4 rotate 0,1,0 tau/4 offset (pi-3)*2 scale 2 shell 0");
  ASSERT_TRUE(p.program) << p.text();
  const auto& made = p.program->instructions;
  EXPECT_THAT(std::vector(made[1].numbers.begin(), made[1].numbers.begin() + 3), ElementsAre(2, 64000, -0.25));
  EXPECT_EQ(made[2].numbers[3], std::numbers::pi / 2);
  EXPECT_EQ(made[3].numbers[0], (std::numbers::pi - 3) * 2);
  EXPECT_EQ(made[4].numbers[2], 2);  // one factor stands for three
}

TEST(Language, AFileStandsForItsWords) {
  const Files files{{"part.txt", "tpms.gyroid  # the sheet\n\tshell '0.7'\n# nothing here\n"},
                    {"sub/outer.txt", "@inner.txt @\"in ner.txt\" union"},
                    {"sub/inner.txt", "ball"},
                    {"sub/in ner.txt", "expression \"x + y\""},
                    {"move.txt", "ball move"}};
  EXPECT_EQ(verbs(parse("@part.txt ball intersection @part.txt union", files)),
            "tpms.gyroid shell ball intersection tpms.gyroid shell union");
  EXPECT_EQ(verbs(parse("@sub/outer.txt complement", files)), "ball expression union complement");
  EXPECT_EQ(parse("@move.txt 1,2,3", files).program->instructions[1].numbers[1], 2);
  EXPECT_EQ(parse("expression @sub/inner.txt", files).code(), Code::sdf_argument);  // verbatim
}

TEST(Language, IncludesThatCannotBe) {
  Files files{{"a.txt", "ball @b.txt"},
              {"b.txt", "@./x/../a.txt"},
              {"quote.txt", "ball\n  move '1,2"},
              {"word.txt", "ball\n\n  bxo"}};
  for (int i = 0; i < 40; ++i) files["deep" + std::to_string(i)] = "@deep" + std::to_string(i + 1);
  files["deep40"] = "ball";
  for (int i = 0; i < 31; ++i)
    files["many" + std::to_string(i)] = "@many" + std::to_string(i + 1) + " @many" + std::to_string(i + 1);
  files["many31"] = "ball";
  EXPECT_THAT(parse("@a.txt", files).text(),
              HasSubstr("b.txt:1:1: error SDF_INCLUDE: word 1: 'a.txt' includes itself"));
  EXPECT_EQ(parse("@none.txt", files).code(), Code::file_not_found);
  EXPECT_THAT(parse("@deep0", files).text(), HasSubstr("deeper than 32"));
  EXPECT_EQ(parse("@deep9", files).text(), "no diagnostic");
  EXPECT_THAT(parse("@many0", files).text(), HasSubstr("more than 100000 words"));
  EXPECT_THAT(parse("@quote.txt", files).text(), HasSubstr("quote.txt:2:8: error SDF_QUOTE"));
  EXPECT_EQ(
      parse("@word.txt union", files).text(),
      "word.txt:3:3: error SDF_UNKNOWN_WORD: word 2: there is no word 'bxo'; did you mean 'box'? (stack depth 1)\n"
      "    bxo\n"
      "    ^~~");
}

TEST(Language, FaultsAreShownInTheWords) {
  EXPECT_EQ(parse("-s 40^3 cylinder move 0,-2,0 cylinder unoin").text(),
            "error SDF_UNKNOWN_WORD: word 7: there is no word 'unoin'; did you mean 'union'? (stack depth 2)\n"
            "  -s 40^3 cylinder move 0,-2,0 cylinder unoin\n"
            "                                        ^~~~~");
  EXPECT_EQ(parse("ball move 1,2/0,3").text(),
            "error SDF_ARGUMENT: word 3: '1,2/0,3' is not dx,dy,dz: '2/0' has no finite value (stack depth 1)\n"
            "  ball move 1,2/0,3\n"
            "              ^~~");
  EXPECT_EQ(parse("expression 'sin(x) ++ y'").text(),
            "error SDF_ARGUMENT: word 2: 'sin(x) ++ y' is not a formula of x, y and z: a value is expected, found '+' "
            "(stack depth 0)\n"
            "  expression 'sin(x) ++ y'\n"
            "                      ^");
}

TEST(Language, WordsOfOtherProgramsAreUnderstoodWell) {
  EXPECT_THAT(parse("sphere").text(), HasSubstr("there is no word 'sphere'; did you mean 'ball'? (stack depth 0)"));
  EXPECT_THAT(parse("ball translate 1,0,0").text(),
              HasSubstr("there is no word 'translate'; did you mean 'move'? Write: move dx,dy,dz (stack depth 1)"));
  EXPECT_THAT(parse("ball roate 0,0,1 pi").text(), HasSubstr("did you mean 'rotate'? Write: rotate x,y,z a"));
  EXPECT_THAT(parse("tmps.gyroid").text(), HasSubstr("did you mean 'tpms.gyroid'?"));
  EXPECT_THAT(parse("ball --samples 1000").text(), HasSubstr("did you mean '-s'? Write: -s n"));
  EXPECT_THAT(parse("'ball scale 2'").text(), HasSubstr("leave out the quotation marks"));
  const Files files{{"bom.txt",
                     "\xEF\xBB\xBF"
                     "ball # with a byte order mark"}};
  EXPECT_EQ(parse("@bom.txt", files).text(), "no diagnostic");
}

TEST(Language, EveryFaultHasItsCode) {
  const std::pair<const char*, Code> cases[] = {
      {"", Code::sdf_stack_left},
      {"-s 10", Code::sdf_stack_left},
      {"ball ball", Code::sdf_stack_left},
      {"complement", Code::sdf_stack_underflow},
      {"ball union", Code::sdf_stack_underflow},
      {"sphere", Code::sdf_unknown_word},
      {"tpms.nothing-like-it", Code::sdf_unknown_word},
      {"ball --fast", Code::sdf_unknown_word},
      {"ball -4", Code::sdf_unknown_word},
      {"@", Code::sdf_unknown_word},
      {"''", Code::sdf_unknown_word},
      {"ball move", Code::sdf_argument_missing},
      {"ball rotate 1,0,0", Code::sdf_argument_missing},
      {"ball -o", Code::sdf_argument_missing},
      {"expression", Code::sdf_argument_missing},
      {"file", Code::sdf_argument_missing},
      {"ball move 1,2", Code::sdf_argument},
      {"ball move 1,2,3,4", Code::sdf_argument},
      {"ball move 1,,3", Code::sdf_argument},
      {"ball move (1,2),3,4", Code::sdf_argument},
      {"ball offset w", Code::sdf_argument},
      {"ball offset 1/0", Code::sdf_argument},
      {"ball offset 1e999", Code::sdf_argument},
      {"ball offset nan", Code::sdf_argument},
      {"ball offset ''", Code::sdf_argument},
      {"ball scale 1,2", Code::sdf_argument},
      {"ball -s 10,10", Code::sdf_argument},
      {"ball -b 0,0,0,1,1", Code::sdf_argument},
      {"ball -o ''", Code::sdf_argument},
      {"expression 'x+w'", Code::sdf_argument},
      {"expression 'x=1'", Code::sdf_argument},
      {"expression ''", Code::sdf_argument},
      {"ball shell -1", Code::sdf_value},
      {"ball eccentric-shell 1,0", Code::sdf_value},
      {"ball scale 0", Code::sdf_value},
      {"ball scale 1,0,1", Code::sdf_value},
      {"ball rotate 0,0,0 1", Code::sdf_value},
      {"ball orient 0,0,0", Code::sdf_value},
      {"ball mirror 0,0,0", Code::sdf_value},
      {"half-space 0,0,0,1", Code::sdf_value},
      {"torus 1,2", Code::sdf_value},
      {"cone 0,0,1", Code::sdf_value},
      {"capsule 0,0,0,1,0,0,0", Code::sdf_value},
      {"ball -s 1", Code::sdf_value},
      {"ball -s 0.5", Code::sdf_value},
      {"ball -s 10,1,10", Code::sdf_value},
      {"ball -s 10,2.5,10", Code::sdf_value},
      {"ball -s 1e10,10,10", Code::sdf_value},
      {"ball -b 0,0,0,1,0,1", Code::sdf_value},
      {"ball -b 0,0,1,1,1,0", Code::sdf_value},
  };
  for (const auto& [line, code] : cases) {
    const Parsed p = parse(line);
    EXPECT_FALSE(p.program) << line;
    EXPECT_EQ(info(p.code()).name, info(code).name) << line << "\n" << p.text();
    EXPECT_EQ(info(p.code()).exit_code, 2) << line;
  }
}

// As in documents: lengths, angles and numbers are told apart where a unit says what they are.
TEST(Language, UnitsFitWhatAWordTakes) {
  for (const char* line : {"ball scale 5mm", "ball scale 2", "ball rotate 0,0,1 30deg", "ball rotate 0,0,1 0.5",
                           "ball move 1mm,2cm,0", "ball -b -1mm,-1,-1,1,1,1", "ball offset '0.1mm*x'",
                           "tpms.gyroid density 0.3", "expression 'sin(x*1deg) + y'", "ball scale '5mm/1mm'"})
    EXPECT_TRUE(parse(line).program) << line << "\n" << parse(line).text();
  const struct {
    const char *line, *says;
  } cases[] = {
      {"ball scale '5mm+3deg'", "'5mm' is a length and '3deg' is an angle"},
      {"ball scale 3deg", "'3deg' is an angle, wanted is a length or a number"},
      {"ball rotate 0,0,1 5mm", "'5mm' is a length, wanted is an angle"},
      {"ball move 1mm,2,3deg", "'3deg' is an angle"},
      {"tpms.gyroid density 0.3mm", "'0.3mm' is a length, wanted is a number"},
      {"ball -s 40mm", "'40mm' is a length, wanted is a number"},
      {"expression 'x + 5mm + 3deg'", "they cannot be added"},
  };
  for (const auto& [line, says] : cases) {
    const Parsed p = parse(line);
    EXPECT_FALSE(p.program) << line;
    EXPECT_THAT(p.text(), HasSubstr(says)) << line;
  }
}

TEST(Language, TheCommandOfTheBodyTextLeavesTwoSolids) {
  // Figure 6 as the paper's text prints it: one intersection is missing.
  const Parsed p =
      parse("ball scale 5 tpms.p scale 4 tpms.d scale 3.75 tpms.gyroid scale 1.25 intersection intersection");
  EXPECT_THAT(p.text(), HasSubstr("the words leave 2 solids on the stack"));
}

TEST(Language, LongLinesAreCutAroundTheFault) {
  std::string line = "ball";
  for (int i = 0; i < 50; ++i) line += " offset 0.1";
  const std::string text = parse(line + " sclae 2" + line.substr(4)).text();
  EXPECT_THAT(text, HasSubstr("did you mean 'scale'?"));
  EXPECT_LT(text.size(), 320u);
  const std::size_t word = text.find("sclae 2"), caret = text.find("^~~~~");
  const auto column = [&](std::size_t at) { return at - text.rfind('\n', at); };
  ASSERT_NE(caret, std::string::npos);
  EXPECT_EQ(column(word), column(caret));
}

}  // namespace
}  // namespace meso::sdf
