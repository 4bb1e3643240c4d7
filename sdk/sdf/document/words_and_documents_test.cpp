// SPDX-License-Identifier: Apache-2.0
#include "meso/sdf_document/words_and_documents.hpp"

#include <gtest/gtest.h>

#include <set>

#include "meso/base/memory_mesh_sink.hpp"
#include "meso/implicit/compile.hpp"
#include "meso/implicit/contour.hpp"
#include "meso/implicit/document_field.hpp"
#include "meso/sdf/build_field.hpp"
#include "meso/sdf/solid_tree.hpp"
#include "meso/validate/validate.hpp"
#include "meso/xml/read.hpp"
#include "meso/xml/write.hpp"

namespace meso::sdf {
namespace {

std::optional<Program> program_of_line(const std::string& line) {
  DiagnosticSink sink;
  auto words = words_of_text(line, "line", sink);
  auto program = parse_program(std::move(*words), {}, sink);
  for (const Diagnostic& d : sink.diagnostics()) ADD_FAILURE() << render(d);
  return program;
}

struct Solid {
  implicit::Field field;
  Box3 box;
};
Solid solid_of(const Program& program) {
  DiagnosticSink sink;
  const auto field = build_field(program, {}, sink);
  for (const Diagnostic& d : sink.diagnostics()) ADD_FAILURE() << render(d);
  return {*field, box_of(program, *field, sink)->box};
}

TriangleMesh mesh_of(const Solid& solid, std::int32_t nodes) {
  DiagnosticSink sink;
  TriangleMesh mesh;
  MemoryMeshSink into(mesh);
  const implicit::Grid grid{.box = solid.box, .nodes = {nodes, nodes, nodes}};
  const auto source = implicit::compile(solid.field.term(), grid, {}, {}, sink);
  EXPECT_TRUE(implicit::contour(*source, into, {}, {}, sink));
  return mesh;
}

std::optional<eval::Evaluation> evaluation_of(const Document& document, DiagnosticSink& sink) {
  auto read = read_document(write_document(document), "part.meso", sink);
  if (!read) return std::nullopt;
  const auto checked = validate(std::move(read->document), std::move(read->source), ".", sink);
  return checked ? eval::Evaluation::make(*checked, {}, sink) : std::nullopt;
}

/// Designs that documents can say: every word that they know at least once.
const char* const designs[] = {
    "ball",
    "box scale 2 ball difference",
    "cone 2,1,3 move 1,0,0 rotate 1,2,3 0.4",
    "cone 2,2,3",
    "torus 2,0.5 scale 1,2,1",
    "tpms.gyroid",
    "tpms.gyroid shell 0.7",
    "tpms.gyroid scale 3 shell 0.7",
    "tpms.gyroid shell 0.7 scale 3",
    "tpms.p offset 0.35 shell 0.4",
    "tpms.d offset 0.3 complement",
    "tpms.p eccentric-shell -0.3,0.5",
    "tpms.p complement eccentric-shell -0.5,0.3",
    "tpms.gyroid complement shell 0.7",
    "ball box move 0.4,0,0 union shell 0.2",
    "ball box move 0.4,0,0 difference rotate 1,2,3 0.4 eccentric-shell -0.1,0.05",
    "ball tpms.gyroid complement intersection offset 0.1",
    "ball box union dup move 1,1,0 union complement shell 0.1",
    "tpms.gyroid cylindrical 8 ball scale 2 intersection offset 0.05 -b -1,-1,-1,1,1,1",
    "tpms.iwp density 0.3",
    "tpms.gyroid scale 3 density '0.3 + 0.05*x'",
    "tpms.gyroid shell '0.3 + 0.1*x*tau/pi'",
    "tpms.gyroid scale 1.3 offset '0.1*(x - y)'",
    "tpms.p eccentric-shell '-0.3 - 0.1*z,0.4'",
    "tpms.q-star-hex",
    "tpms.gyroid scale 1,2,3",
    "tpms.gyroid rotate 1,2,3 0.3 move 0.2,0.1,0",
    "tpms.gyroid scale 3 ball scale 4 intersection",
    "tpms.gyroid tpms.p blend '(x + 1)/2' shell 0.3",
    "tpms.gyroid tpms.p blend '(x + 1)/2' expression 'x*y' blend 0.1 scale 1.5",
    "tpms.gyroid scale 2 density 0.2 tpms.p scale 2 density '0.3 + 0.1*y' blend '(x + tau/6.2)/2' move 0.1,0,0",
    "tpms.d density 0.3 tpms.p density 0.3 blend 0.4 tpms.iwp density 0.5 blend 0.3 cylindrical 8 -b -2,-2,0,2,2,1",
    "ball shell 0.2",
    "ball move 1,0,0 shell 0.2",
    "ball scale 3 shell 0.3 box scale 2 intersection",
    "box offset 0.25",
    "torus 2,0.5 shell 0.2",
    "capsule -1,0,0,1,0.5,0,0.4",
    "capsule -1,0,0,1,0.5,0,0.4 shell 0.1",
    "half-space 1,1,1,0.5",
    "cylinder orient 1,0,0 complement box intersection",
    "cylinder orient 0,0,-1",
    "expression 'x^2 + y^4 + z^2 - tau/6'",
    "expression 'x^2 + y^2 - z' scale 0.5 shell '0.1 + z^2/10'",
    "ball box move 1,1,1 union",
    "ball box move 1,1,1 smooth-union 0.3",
    "ball box union complement",
    "ball box move 0.5,0.5,0.5 union mirror 1,1,0",
    "cone 1,0,2 tpms.p union scale -1,1,2",
    "ball scale 0.3 repeat 1,0.8,0.7 box intersection",
    "ball scale 0.4 move 0.1,0,0.3 repeat 1,0,1",
    "cylinder scale 0.3 orient 0,1,0 move 1.2,0,0 repeat 0,0,1 helix 1,1 -b -2,-2,0,2,2,4",
    "strut.bcc 0.08",
    "strut.octet 0.05 scale 2.5 ball scale 3 intersection",
    "tpms.gyroid shell 0.3 cylindrical 12",
    "tpms.gyroid density 0.4 cylindrical 12 cylinder scale 2.9 intersection cylinder difference -b -3,-3,0,3,3,2",
    "tpms.p cylindrical -5 shell '0.3' -b -1,-1,-1,2,2,1",
    "strut.bcc 0.1 scale 0.5 cylindrical 4",
    "ball move 1,0,0 box union cylindrical 7 move 0.1,0.2,0.3 cylindrical 3",
    "expression 'x + y/3 + z^2 - 1' cylindrical 2",
    "tpms.p shell 0.6 spherical 12,6 ball scale 2.9 intersection half-space 1,-1,0,0 intersection",
    "strut.octet 0.06 spherical -7,-3 -b -2,-2,-2,2,2,2",
    "tpms.p shell 0.8 helix 8,3 cylinder scale 2.9 intersection cylinder scale 0.9 difference -b -3,-3,0,3,3,4",
    "strut.octet 0.06 helix -5,-2 rotate 1,1,1 0.4 -b -2,-2,-1,2,2,2",
    "tpms.gyroid helix 5,0 complement",
    "ball dup box swap difference over union drop",
    "tpms.gyroid scale 2 def core ball scale 2 recall core intersection ball scale 0.5 union",
};

TEST(WordsAndDocuments, TheSameMeshFromBoth) {
  for (const char* const design : designs) {
    const auto program = program_of_line(design);
    const Solid solid = solid_of(*program);
    DiagnosticSink sink;
    const auto document = document_of(*program, solid.box, "", sink);
    const auto evaluation = document ? evaluation_of(*document, sink) : std::nullopt;
    WhyNot why;
    const auto again = evaluation ? program_of(*evaluation, "", why) : std::nullopt;
    for (const Diagnostic& d : sink.diagnostics()) ADD_FAILURE() << design << ": " << render(d);
    ASSERT_TRUE(again) << design << ": " << why.element << ": " << why.why << "\n" << write_document(*document);
    EXPECT_EQ(again->samples, program->samples);
    const Solid same = solid_of(*again);
    EXPECT_EQ(same.box.min, solid.box.min) << design;
    EXPECT_EQ(same.box.max, solid.box.max) << design;
    const TriangleMesh a = mesh_of(solid, 24), b = mesh_of(same, 24);
    EXPECT_EQ(a.points, b.points) << design << "\n" << command_line(*again);
    EXPECT_EQ(a.triangles, b.triangles) << design;
    // And as a line of words.
    const auto printed = program_of_line(command_line(*again));
    const TriangleMesh c = mesh_of(solid_of(*printed), 24);
    EXPECT_EQ(a.points, c.points) << design << "\n" << command_line(*again);
  }
}

// The document says the same by its own rules: cells cut to boxes, patterns that end, bodies joined by a seam.
TEST(WordsAndDocuments, TheDocumentMeansTheSame) {
  for (const char* const design : designs) {
    const auto program = program_of_line(design);
    const Solid solid = solid_of(*program);
    DiagnosticSink sink;
    const auto document = document_of(*program, solid.box, "", sink);
    const auto evaluation = evaluation_of(*document, sink);
    const auto part =
        implicit::field_of_part(*evaluation, *evaluation->find_part(document->build.items[0].part.text), {}, sink);
    for (const Diagnostic& d : sink.diagnostics()) ADD_FAILURE() << design << ": " << render(d);
    ASSERT_TRUE(part) << design;
    int near = 0, wrong = 0;
    const implicit::Grid grid{.box = solid.box, .nodes = {13, 13, 13}};
    const Vec3 size = solid.box.max - solid.box.min;
    for (int k = 0; k < 12; ++k)
      for (int j = 0; j < 12; ++j)
        for (int i = 0; i < 12; ++i) {
          const Vec3 p = grid.node(i, j, k) + Vec3{0.037 * size.x, 0.041 * size.y, 0.029 * size.z};
          const double f = solid.field.value(p);
          // Shares are looked up in tables of other points.
          const bool is_clear = std::abs(f) > 0.02;
          near += is_clear ? 0 : 1;
          wrong += is_clear && (f < 0) != (part->field.value(p) < 0) ? 1 : 0;
        }
    EXPECT_EQ(wrong, 0) << design << "\n" << write_document(*document);
    EXPECT_LT(near, 600) << design;
  }
}

TEST(WordsAndDocuments, EveryWordIsInADesign) {
  std::set<std::string> said;
  for (const char* const design : designs) {
    const auto program = program_of_line(design);
    for (const Instruction& word : program->instructions) said.insert(std::string(word_of(word.verb)));
  }
  for (const Vocable& v : vocabulary()) EXPECT_TRUE(said.contains(std::string(v.word)) || v.word == "file") << v.word;
}

TEST(WordsAndDocuments, WhatADocumentCannotSayIsNamed) {
  const std::pair<const char*, const char*> cases[] = {
      {"cone 1,0,1 offset 0.1 cylindrical 8", "cone"},
      {"ball box union scale 2 shell 0.1", "shell"},
      {"ball box union shell 0.1 offset 0.1", "offset"},
      {"ball box smooth-union 0.1 offset 0.1", "offset"},
      {"ball box union offset 0.1*x", "offset"},
      {"tpms.gyroid shell 0.1 shell 0.05", "shell"},
      {"tpms.gyroid offset 0.1 offset 0.1", "offset"},
      {"cone 1,0,1 offset 0.1", "cone"},
      {"strut.bcc 0.1 offset 0.1", "offset"},
      {"tpms.gyroid cylindrical 8 tpms.p blend x", "cylindrical"},
      {"ball scale 1,2,3 shell 0.1", "scale"},
      {"tpms.gyroid scale 2 density 0.3 tpms.p density 0.3 blend x", "density"},
      {"tpms.gyroid density 0.3 strut.bcc 0.1 density 0.3 blend x", "strut.bcc"},
      {"tpms.gyroid density 0.3 tpms.p density 0.3 blend x offset 0.1", "offset"},
      {"tpms.d density 0.3 tpms.gyroid density 0.3 tpms.p density 0.3 blend x blend y", "blend"},
      {"tpms.gyroid density 0.3 tpms.p blend x", "density"},
  };
  for (const auto& [design, word] : cases) {
    const auto program = program_of_line(design);
    DiagnosticSink sink;
    EXPECT_FALSE(document_of(*program, {{-1, -1, -1}, {1, 1, 1}}, "", sink)) << design;
    ASSERT_EQ(sink.diagnostics().size(), 1u) << design;
    EXPECT_EQ(sink.diagnostics()[0].code, Code::sdf_not_a_document) << design;
    EXPECT_EQ(sink.diagnostics()[0].args[0], word) << design;
  }
}

// Of a document that bends otherwise than words do, why it is none is told; what bends alike in other words is printed.
TEST(WordsAndDocuments, BendsThatNoWordSays) {
  const auto program = program_of_line("tpms.gyroid helix 8,1 -b -1,-1,-1,1,1,1");
  DiagnosticSink sink;
  const std::string text = write_document(*document_of(*program, *program->box, "", sink));
  const auto printed = [&](std::string_view was, std::string_view is) {
    std::string changed = text;
    const std::size_t at = changed.find(was);
    if (at == std::string::npos) return "no '" + std::string(was) + "' in " + text;
    changed.replace(at, was.size(), is);
    auto read = read_document(changed, "part.meso", sink);
    const auto checked = validate(std::move(read->document), std::move(read->source), ".", sink);
    if (!checked) return render(sink.diagnostics().back());
    WhyNot why;
    const auto again = program_of(*eval::Evaluation::make(*checked, {}, sink), "", why);
    const std::string bounds = " -b -1,-1,-1,1,1,1 -s 1e+06";
    if (!again) return why.why;
    const std::string line = command_line(*again);
    return line.ends_with(bounds) ? line.substr(0, line.size() - bounds.size()) : line;
  };
  EXPECT_EQ(printed("gyroid", "gyroid"), "tpms.gyroid helix 8,1");
  EXPECT_EQ(printed("id=\"helix2Turn\" value=\"8\"", "id=\"helix2Turn\" value=\"2*3\""), "tpms.gyroid helix 6,1");
  EXPECT_EQ(printed("id=\"helix2Rise\" value=\"1\"", "id=\"helix2Rise\" value=\"-0.5\""), "tpms.gyroid helix 8,-0.5");
  EXPECT_EQ(printed("spacing=\"2*pi\"", "spacing=\"360deg\""), "tpms.gyroid helix 8,1");
  const std::string otherwise = "a cell that is not bent once round the z axis, or once round from pole to pole";
  EXPECT_EQ(printed("spacing=\"2*pi\"", "spacing=\"pi\""), otherwise);
  EXPECT_EQ(printed("start=\"-pi\"", "start=\"0\""), otherwise);
  EXPECT_EQ(printed("kind=\"circular\" z=\"1\"", "kind=\"circular\" z=\"1\" x=\"0.1\""), otherwise);
  EXPECT_EQ(printed("dx=\"1.6\"", "dx=\"1.5\""), otherwise);
  EXPECT_EQ(printed(" clipToBox=\"true\"", ""), "bent cells that are not one part, cut to its box");
  EXPECT_EQ(printed("helix2Rise/helix2Turn", "helix2Rise/8"), "a placement that is not written as a mirror or a scale");
  EXPECT_EQ(printed("<mesh samples=\"1000000\" x=\"-1\"", "<mesh samples=\"1000000\" x=\"-2\""),
            "a bent cell that does not reach to the bounds; words cut nothing");
}

TEST(WordsAndDocuments, AllThatIsNoWordIsTold) {
  const auto program = program_of_line("tpms.gyroid offset 0.1*x ball union box difference -b 0,0,0,4,2,2");
  DiagnosticSink sink;
  std::string text = write_document(*document_of(*program, *program->box, "", sink));
  const auto change = [&](std::string_view was, std::string_view is) {
    ASSERT_NE(text.find(was), std::string::npos) << was << " in " << text;
    text.replace(text.find(was), was.size(), is);
  };
  change("</fill>", "</fill><translate x=\"0.5\"/>");
  change("radius=\"0\"", "");
  change("radius=\"0\"", "fragments=\"drop\"");
  change("unit=\"millimeter\"", "unit=\"centimeter\"");
  auto read = read_document(text, "part.meso", sink);
  const auto checked = validate(std::move(read->document), std::move(read->source), ".", sink);
  ASSERT_TRUE(checked) << render(sink.diagnostics().back());
  const auto evaluation = eval::Evaluation::make(*checked, {}, sink);
  std::set<std::string> told;
  for (const WhyNot& why : all_that_is_no_word(*evaluation, "")) told.insert(why.why);
  EXPECT_EQ(told, (std::set<std::string>{"its unit is not the millimetre", "an instruction that no word says",
                                         "a step without radius=\"0\"", "a rule for fragments"}));
  WhyNot first;
  EXPECT_FALSE(program_of(*evaluation, "", first));
  EXPECT_EQ(first.why, "its unit is not the millimetre");
}

// What words do not say must not be left out: cells that are moved, chosen or set one by one, weights that are errors.
TEST(WordsAndDocuments, WhatCellsHaveBeyondWordsIsNoWord) {
  const auto program = program_of_line("tpms.gyroid density 0.3 tpms.p density 0.3 blend x/4 -b 0,0,0,4,2,2");
  DiagnosticSink sink;
  const std::string blend = write_document(*document_of(*program, *program->box, "", sink));
  const auto graded = program_of_line("tpms.gyroid offset 0.1*x -b 0,0,0,4,2,2");
  const std::string level = write_document(*document_of(*graded, *graded->box, "", sink));
  const auto why_not = [&](std::string text, std::string_view was, std::string_view is) {
    const std::size_t at = text.find(was);
    if (at == std::string::npos) return "no '" + std::string(was) + "' in " + text;
    text.replace(at, was.size(), is);
    auto read = read_document(text, "part.meso", sink);
    const auto checked = validate(std::move(read->document), std::move(read->source), ".", sink);
    if (!checked) return render(sink.diagnostics().back());
    WhyNot why;
    const auto again = program_of(*eval::Evaluation::make(*checked, {}, sink), "", why);
    return again ? command_line(*again) : why.why;
  };
  const std::string instruction = "an instruction that no word says";
  for (const std::string& text : {blend, level}) {
    EXPECT_EQ(why_not(text, "</fill>", "</fill><translate x=\"0.5\"/>"), instruction);
    EXPECT_EQ(why_not(text, "</fill>", "</fill><when test=\"global.x &lt; 2\"/>"), instruction);
    EXPECT_EQ(why_not(text, " at=\"point\"", ""), instruction);
  }
  EXPECT_EQ(why_not(level, "isovalue=\"", "isovalue=\"2*"), "'2*offset2Level' has names that words do not know");
  EXPECT_EQ(why_not(blend, "clamp(global.x/4, 0, 1)", "global.x/4"), "a weight that is not clamped from 0 to 1");
  EXPECT_EQ(why_not(blend, " density=\"density2Share\"", " isovalue=\"0\""),
            "a blend of surfaces by name without a density, which weighs them by their size");
}

}  // namespace
}  // namespace meso::sdf
