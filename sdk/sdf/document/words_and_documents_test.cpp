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
    "strut.bcc 0.08",
    "strut.octet 0.05 scale 2.5 ball scale 3 intersection",
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
  for (const Vocable& v : vocabulary())
    EXPECT_TRUE(said.contains(std::string(v.word)) || v.word == "file" || v.word == "cylindrical" ||
                v.word == "spherical" || v.word == "helix")
        << v.word;
}

TEST(WordsAndDocuments, WhatADocumentCannotSayIsNamed) {
  const std::pair<const char*, const char*> cases[] = {
      {"tpms.gyroid cylindrical 8", "cylindrical"},
      {"tpms.gyroid spherical 8,4 ball intersection", "spherical"},
      {"tpms.gyroid helix 8,1", "helix"},
      {"ball box union shell 0.1", "shell"},
      {"tpms.gyroid shell 0.1 shell 0.05", "shell"},
      {"tpms.gyroid offset 0.1 offset 0.1", "offset"},
      {"cone 1,0,1 offset 0.1", "cone"},
      {"strut.bcc 0.1 offset 0.1", "offset"},
      {"ball repeat 1,0,1", "repeat"},
      {"ball scale 1,2,3 shell 0.1", "scale"},
  };
  for (const auto& [design, word] : cases) {
    const auto program = program_of_line(design);
    const Solid solid = solid_of(*program);
    DiagnosticSink sink;
    EXPECT_FALSE(document_of(*program, solid.box, "", sink)) << design;
    ASSERT_EQ(sink.diagnostics().size(), 1u) << design;
    EXPECT_EQ(sink.diagnostics()[0].code, Code::sdf_not_a_document) << design;
    EXPECT_EQ(sink.diagnostics()[0].args[0], word) << design;
  }
}

}  // namespace
}  // namespace meso::sdf
