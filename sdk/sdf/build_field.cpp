// SPDX-License-Identifier: Apache-2.0
#include "meso/sdf/build_field.hpp"

#include <cassert>
#include <cmath>
#include <map>
#include <numbers>

#include "meso/base/number.hpp"

namespace meso::sdf {

using implicit::Field;

namespace {

class Builder {
 public:
  Builder(const MeshLoader& load_mesh, DiagnosticSink& sink) : load_mesh_(load_mesh), sink_(sink) {}

  std::optional<Field> build(const Program& program) {
    for (const Instruction& instruction : program.instructions) {
      auto made = carry_out(instruction);
      if (!made) return std::nullopt;
      stack_.push_back(std::move(*made));
    }
    assert(stack_.size() == 1);  // parse_program() counted
    return std::move(stack_.back());
  }

 private:
  std::optional<Field> carry_out(const Instruction& instruction) {
    const auto& n = instruction.numbers;
    const Vec3 v{n[0], n[1], n[2]};
    switch (instruction.verb) {
      case Verb::ball:
        return Field::ball();
      case Verb::cylinder:
        return Field::cylinder();
      case Verb::box:
        return Field::box();
      case Verb::cone:
        return Field::cone(n[0], n[1], n[2]);
      case Verb::torus:
        return Field::torus(n[0], n[1]);
      case Verb::capsule:
        return Field::capsule(v, {n[3], n[4], n[5]}, n[6]);
      case Verb::half_space:
        return Field::half_space(v, n[3]);
      case Verb::surface:
        return Field::surface(instruction.text, sink_);
      case Verb::expression:
        return expression(instruction);
      case Verb::file:
        return mesh(instruction);
      case Verb::complement:
        return pop().complement();
      case Verb::offset:
        return pop().offset(n[0]);
      case Verb::shell:
        return pop().shell(n[0]);
      case Verb::eccentric_shell:
        return pop().eccentric_shell(n[0], n[1]);
      case Verb::move:
        return pop().translated(v);
      case Verb::scale:
        return v.x == v.y && v.y == v.z ? pop().scaled(v.x) : pop().scaled(v);
      case Verb::rotate:
        return pop().rotated(v, n[3]);
      case Verb::orient:
        return pop().oriented(v);
      case Verb::mirror:
        return pop().mirrored(v);
      case Verb::union_of:
        return pair(implicit::union_of);
      case Verb::intersection:
        return pair(implicit::intersection_of);
      case Verb::difference:
        return pair(implicit::difference_of);
    }
    return std::nullopt;
  }

  Field pop() {
    Field top = std::move(stack_.back());
    stack_.pop_back();
    return top;
  }
  Field pair(Field (*join)(const Field&, const Field&)) {
    const Field above = pop();
    return join(pop(), above);
  }

  std::optional<Field> expression(const Instruction& instruction) {
    const implicit::Parameter tau[] = {{"tau", 2 * std::numbers::pi}};
    return Field::expression(instruction.text, sink_, tau);
  }

  std::optional<Field> mesh(const Instruction& instruction) {
    auto& loaded = loaded_[instruction.text];
    if (!loaded) {
      DiagnosticSink told;
      loaded = load_mesh_(instruction.text, told);
      for (Diagnostic d : told.diagnostics()) {
        if (d.where.file.empty()) point_at(d, instruction.word);
        sink_.report(std::move(d));
      }
    }
    return loaded ? std::optional(Field::external(loaded)) : std::nullopt;
  }

  const MeshLoader& load_mesh_;
  DiagnosticSink& sink_;
  std::vector<Field> stack_;
  std::map<std::string, std::shared_ptr<const implicit::ExternalField>> loaded_;
};

}  // namespace

std::optional<Field> build_field(const Program& program, const MeshLoader& load_mesh, DiagnosticSink& sink) {
  return Builder(load_mesh, sink).build(program);
}

std::optional<ProgramBox> box_of(const Program& program, const Field& field, DiagnosticSink& sink) {
  if (program.box) return ProgramBox{*program.box};
  const Box3 own = field.bounds();
  // A box without thickness holds no inside either: zero is outside.
  if (!(own.min.x < own.max.x && own.min.y < own.max.y && own.min.z < own.max.z))
    return ProgramBox{.box = {{-1, -1, -1}, {1, 1, 1}}, .certainly_empty = true};
  Box3 box = own;
  bool inverted = false;
  for (std::size_t i = 0; i < 3; ++i) {
    if (std::isinf(box.min[i])) box.min[i] = -1;
    if (std::isinf(box.max[i])) box.max[i] = 1;
    inverted = inverted || !(box.min[i] < box.max[i]);
  }
  if (!inverted) return ProgramBox{box};
  std::string text;
  for (const Vec3 corner : {own.min, own.max})
    for (std::size_t i = 0; i < 3; ++i) text += (text.empty() ? "" : ",") + format_number(corner[i]);
  sink.report({.code = Code::sdf_box, .args = {text}});
  return std::nullopt;
}

}  // namespace meso::sdf
