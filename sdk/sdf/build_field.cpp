// SPDX-License-Identifier: Apache-2.0
#include "meso/sdf/build_field.hpp"

#include <cmath>
#include <map>
#include <numbers>

#include "arguments.hpp"
#include "filling.hpp"
#include "meso/base/number.hpp"
#include "meso/implicit/density_table.hpp"
#include "meso/implicit/point_function.hpp"
#include "meso/implicit/surfaces.hpp"
#include "meso/sdf/solid_tree.hpp"
#include "place_of_solid.hpp"
#include "strut_cells.hpp"

namespace meso::sdf {

using expr::Op;
using implicit::Field;
using implicit::Term;

namespace {

/// A solid, and after which steps along the axes it repeats (0: not, or nobody knows).
struct Solid {
  Field field;
  Vec3 period{};
  std::optional<Filling> filling{};  ///< of a share of each period
};

class Builder {
 public:
  Builder(const MeshLoader& load_mesh, DiagnosticSink& sink) : load_mesh_(load_mesh), sink_(sink) {}

  std::optional<Field> build(const Program& program) {
    const SolidTree tree = solid_tree(program);
    for (const SolidTree::Node& node : tree.nodes) {
      auto solid = made(node);
      if (!solid) return std::nullopt;
      solids_.push_back(std::move(*solid));
    }
    return std::move(solids_.back().field);
  }

 private:
  std::optional<Solid> made(const SolidTree::Node& node) {
    const Instruction& instruction = *node.made_by;
    if (node.of.empty()) return leaf(instruction);
    const Solid& below = solids_[node.of[0]];
    if (node.of.size() == 1) return changed(instruction, below);
    const Solid& above = solids_[node.of[1]];
    if (instruction.verb == Verb::blend) return blended(instruction, below, above);
    return Solid{joined(instruction, below.field, above.field)};
  }

  std::optional<Solid> leaf(const Instruction& instruction) {
    const auto& n = instruction.numbers;
    const Vec3 v{n[0], n[1], n[2]};
    switch (instruction.verb) {
      case Verb::ball:
        return Solid{Field::ball()};
      case Verb::cylinder:
        return Solid{Field::cylinder()};
      case Verb::box:
        return Solid{Field::box()};
      case Verb::cone:
        return Solid{Field::cone(n[0], n[1], n[2])};
      case Verb::torus:
        return Solid{Field::torus(n[0], n[1])};
      case Verb::capsule:
        return Solid{Field::capsule(v, {n[3], n[4], n[5]}, n[6])};
      case Verb::half_space:
        return Solid{Field::half_space(v, n[3])};
      case Verb::surface:
        return surface(instruction);
      case Verb::strut: {
        const StrutLattice lattice = strut_lattice(instruction.text, n[0]);
        return Solid{Field::from_term(lattice.term), lattice.period};
      }
      case Verb::expression: {
        const implicit::Parameter tau[] = {{"tau", 2 * std::numbers::pi}};
        const auto field = Field::expression(instruction.text, sink_, tau);
        return field ? std::optional(Solid{*field}) : std::nullopt;
      }
      default:
        return mesh(instruction);
    }
  }

  std::optional<Solid> changed(const Instruction& instruction, const Solid& solid) {
    const auto& n = instruction.numbers;
    const Vec3 v{n[0], n[1], n[2]};
    const Field& f = solid.field;
    switch (instruction.verb) {
      case Verb::complement:
        return Solid{f.complement(), solid.period};
      case Verb::offset:
      case Verb::shell:
      case Verb::eccentric_shell:
        return Solid{instruction.text.empty() ? level(instruction, f) : graded_level(instruction, f), solid.period};
      case Verb::density:
        return filled(instruction, solid);
      case Verb::move:
        return moved(solid, f.translated(v), Affine::from_translation(-v), solid.period);
      case Verb::scale:
        return moved(solid, v.x == v.y && v.y == v.z ? f.scaled(v.x) : f.scaled(v),
                     Affine::from_rows({1 / v.x, 0, 0, 0, 0, 1 / v.y, 0, 0, 0, 0, 1 / v.z, 0}),
                     {std::abs(v.x) * solid.period.x, std::abs(v.y) * solid.period.y, std::abs(v.z) * solid.period.z});
      case Verb::rotate:
        return Solid{f.rotated(v, n[3])};
      case Verb::orient:
        return Solid{f.oriented(v)};
      case Verb::mirror:
        return Solid{f.mirrored(v)};
      default:
        break;
    }
    const Term there = implicit::taken_from(f.term(), bent(instruction));
    return Solid{Field::from_term(there), instruction.verb == Verb::repeat ? v : Vec3{}};
  }

  static Solid moved(const Solid& from, const Field& field, const Affine& source_from_target, Vec3 period) {
    return {field, period,
            from.filling ? std::optional(from.filling->moved(source_from_target, period)) : std::nullopt};
  }

  static Field level(const Instruction& instruction, const Field& f) {
    const auto& n = instruction.numbers;
    if (instruction.verb == Verb::offset) return f.offset(n[0]);
    return instruction.verb == Verb::shell ? f.shell(n[0]) : f.eccentric_shell(n[0], n[1]);
  }
  static Field graded_level(const Instruction& instruction, const Field& field) {
    const Term f = field.term();
    std::vector<Term> at;
    for (const expr::ListItem& item : expr::split_list(instruction.text)) at.push_back(term_of(item.text));
    if (instruction.verb == Verb::offset) return Field::from_term(f - at[0]);
    if (instruction.verb == Verb::shell) return Field::from_term(abs(f) - 0.5 * at[0]);
    return Field::from_term(max(at[0] - f, f - at[1]));
  }

  /// {f < level} holds the share of each period.
  std::optional<Solid> filled(const Instruction& instruction, const Solid& solid) {
    const Vec3 period = solid.period;
    if (!(period.x > 0 && period.y > 0 && period.z > 0))
      return fault(instruction, "what lies below it does not repeat along all axes, so it has no period to fill");
    const Term f = solid.field.term();
    const auto table = std::make_shared<const implicit::DensityTable>(
        [&](auto) { return f; }, implicit::DensityTable::Room{{}, period}, std::vector<implicit::Interval>{});
    if (instruction.text.empty())
      return Solid{solid.field.offset(table->level(instruction.numbers[0], {})), period,
                   Filling(f, period, Term::constant(instruction.numbers[0]))};
    const Term share = term_of(instruction.text);
    return Solid{Field::from_term(f - density_level(table, share, {})), {}, Filling(f, period, share)};
  }

  std::optional<Solid> blended(const Instruction& instruction, const Solid& below, const Solid& above) {
    const Term weight = Term::apply(Op::clamp, {term_of(instruction.text), Term::constant(0), Term::constant(1)});
    const auto filling =
        below.filling && above.filling ? Filling::blended(*below.filling, *above.filling, weight) : std::nullopt;
    if (!filling) {
      const Term a = below.field.term();
      return Solid{Field::from_term(a + weight * (above.field.term() - a))};
    }
    if (filling->varying() > Filling::most_varying)
      return fault(instruction, "densities of at most three solids blend by formulas; state an offset for the others");
    return Solid{Field::from_term(filling->body()), {}, filling};
  }

  static Field joined(const Instruction& instruction, const Field& below, const Field& above) {
    switch (instruction.verb) {
      case Verb::union_of:
        return union_of(below, above);
      case Verb::intersection:
        return intersection_of(below, above);
      case Verb::difference:
        return difference_of(below, above);
      default:
        return union_of(below, above, instruction.numbers[0]);
    }
  }

  std::optional<Solid> surface(const Instruction& instruction) {
    const auto field = Field::surface(instruction.text, sink_);
    const double along_y = implicit::find_surface(instruction.text)->name == "q-star-hex" ? std::numbers::sqrt3 : 1;
    return field ? std::optional(Solid{*field, {1, along_y, 1}}) : std::nullopt;
  }

  std::optional<Solid> mesh(const Instruction& instruction) {
    auto& loaded = loaded_[instruction.text];
    if (!loaded) {
      DiagnosticSink told;
      loaded = load_mesh_(instruction.text, told);
      for (Diagnostic d : told.diagnostics()) {
        if (d.where.file.empty()) point_at(d, instruction.word);
        sink_.report(std::move(d));
      }
    }
    return loaded ? std::optional(Solid{Field::external(loaded)}) : std::nullopt;
  }

  std::nullopt_t fault(const Instruction& instruction, std::string why) {
    const Word& word = instruction.word;
    Diagnostic d{.code = Code::sdf_value,
                 .args = {std::to_string(word.number), std::to_string(instruction.depth), word.text, std::move(why)}};
    point_at(d, word);
    sink_.report(std::move(d));
    return std::nullopt;
  }

  const MeshLoader& load_mesh_;
  DiagnosticSink& sink_;
  std::vector<Solid> solids_;
  std::map<std::string, std::shared_ptr<const implicit::ExternalField>> loaded_;
};

}  // namespace

std::optional<Field> build_field(const Program& program, const MeshLoader& load_mesh, DiagnosticSink& sink) {
  return Builder(load_mesh, sink).build(program);
}

// As documents state boxes, which mean the same to the last bit.
Box3 corner_and_size(const Box3& box) { return {box.min, box.min + (box.max - box.min)}; }

std::optional<ProgramBox> box_of(const Program& program, const Field& field, DiagnosticSink& sink) {
  if (program.box) return ProgramBox{corner_and_size(*program.box)};
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
  if (!inverted) return ProgramBox{corner_and_size(box)};
  std::string text;
  for (const Vec3 corner : {own.min, own.max})
    for (std::size_t i = 0; i < 3; ++i) text += (text.empty() ? "" : ",") + format_number(corner[i]);
  sink.report({.code = Code::sdf_box, .args = {text}});
  return std::nullopt;
}

}  // namespace meso::sdf
