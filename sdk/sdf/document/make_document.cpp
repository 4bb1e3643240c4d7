// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numbers>

#include "document_maker.hpp"
#include "leaf_formulas.hpp"

namespace meso::sdf {

std::optional<Document> DocumentMaker::make(const Program& program, const Box3& box) {
  document_.metadata.push_back({.name = "title", .text = "A design in words, as a document"});
  const auto solid = operand(static_cast<Index>(tree_.nodes.size() - 1), box);
  const auto part = solid ? part_of(*solid, "solid") : std::nullopt;
  if (!part) return std::nullopt;
  MeshSettings mesh;
  const auto text = [](double v) { return Expression{format_number(v)}; };
  std::string samples;
  for (const double n : program.samples) {
    const bool is_whole = n == std::round(n) && n < 1e15;
    samples += (samples.empty() ? "" : ", ") + (is_whole ? std::to_string(std::llround(n)) : format_number(n));
  }
  mesh.samples = ExpressionList{samples};
  mesh.x = text(box.min.x), mesh.y = text(box.min.y), mesh.z = text(box.min.z);
  mesh.dx = text(box.max.x - box.min.x), mesh.dy = text(box.max.y - box.min.y), mesh.dz = text(box.max.z - box.min.z);
  document_.build.items.push_back({.part = {*part}, .mesh = std::move(mesh)});
  return std::move(document_);
}

std::optional<Operand> DocumentMaker::operand(Index node, const Box3& region) {
  const std::array<double, 6> corners{region.min.x, region.min.y, region.min.z,
                                      region.max.x, region.max.y, region.max.z};
  if (const auto known = made_.find({node, corners}); known != made_.end()) return known->second;
  ++visits_[node];
  const auto made = new_operand(node, region);
  if (made) made_.emplace(std::pair(node, corners), *made);
  return made;
}

std::optional<Operand> DocumentMaker::new_operand(Index node, const Box3& region) {
  constexpr std::size_t deepest = 400;
  if (++depth_ > deepest) return fault(node, "solids are made of solids more than 400 deep");
  struct Leave {
    std::size_t& depth;
    ~Leave() { --depth; }
  } leave{depth_};
  const Verb verb = word(node).verb;
  if (is_csg(node)) return macrostructure(node);
  switch (verb) {
    case Verb::union_of:
    case Verb::intersection:
    case Verb::difference:
    case Verb::smooth_union:
      return joined(node, region);
    case Verb::repeat:
      return repeated(node, region);
    case Verb::file:
      return file(node);
    case Verb::strut:
      return strut(node, region, nullptr);
    case Verb::cylindrical:
    case Verb::spherical:
    case Verb::helix:
      return bent(node, region);
    default:
      break;
  }
  if (verb == Verb::scale && has_positive_factors(word(node)) && word(below(node)).verb == Verb::strut)
    return strut(below(node), region, &word(node));
  const bool is_scaled_surface =
      verb == Verb::scale && has_positive_factors(word(node)) && word(below(node)).verb == Verb::surface;
  if (is_move(verb) && !is_scaled_surface) return moved(node, region);
  if (verb == Verb::complement && !chain_of(node)) return complement(node, region);
  return cell(node, region);
}

std::optional<std::string> DocumentMaker::part_of(const Operand& operand, const std::string& name) {
  if (operand.kind == Operand::Kind::part) return operand.id;
  const auto [known, is_new] = parts_.try_emplace(operand.id, name);
  if (!is_new) return known->second;
  Part part{.id = {name}};
  if (operand.kind == Operand::Kind::macrostructure)
    part.macrostructure = Ref<Macrostructure>{operand.id};
  else
    part.steps.push_back({.pattern = Ref<Pattern>{operand.id}});
  document_.parts.items.push_back(std::move(part));
  return name;
}

// A step that states its radius joins functions as they are, which is what words do.
std::optional<Operand> DocumentMaker::joined(Index node, const Box3& region) {
  const Instruction& at = word(node);
  const auto left = operand(below(node), region), right = left ? operand(below(node, 1), region) : std::nullopt;
  if (!left || !right) return std::nullopt;
  Part part{.id = {name(node)}};
  if (left->kind == Operand::Kind::macrostructure)
    part.macrostructure = Ref<Macrostructure>{left->id};
  else if (left->kind == Operand::Kind::part)
    part.steps.push_back({.part = Ref<Part>{left->id}});
  else
    part.steps.push_back({.pattern = Ref<Pattern>{left->id}});
  Apply step;
  step.operation = at.verb == Verb::intersection ? ApplyOperation::intersection
                   : at.verb == Verb::difference ? ApplyOperation::difference
                                                 : ApplyOperation::union_;
  step.radius = at.verb == Verb::smooth_union ? number(name(node) + "Radius", at.numbers[0]) : Expression{"0"};
  if (right->kind == Operand::Kind::pattern)
    step.pattern = Ref<Pattern>{right->id};
  else
    step.part = Ref<Part>{*part_of(*right, right->id + "Part")};
  part.steps.push_back(std::move(step));
  document_.parts.items.push_back(std::move(part));
  return Operand{Operand::Kind::part, name(node)};
}

/// All of the region but what is below.
std::optional<Operand> DocumentMaker::complement(Index node, const Box3& region) {
  const auto inner = operand(below(node), region);
  if (!inner) return std::nullopt;
  const CellBox around = cell_box(with_room(region));
  BoxPrimitive box{.x = around.x, .y = around.y, .z = around.z, .dx = around.dx, .dy = around.dy, .dz = around.dz};
  const std::string id = name(node);
  document_.macrostructures.items.push_back(
      {.id = {id + "Space"}, .body = CsgBody{.operands = {CsgNode{std::move(box)}}}});
  Apply step{.operation = ApplyOperation::difference, .radius = Expression{"0"}};
  if (inner->kind == Operand::Kind::pattern)
    step.pattern = Ref<Pattern>{inner->id};
  else
    step.part = Ref<Part>{*part_of(*inner, inner->id + "Part")};
  document_.parts.items.push_back(
      {.id = {id}, .macrostructure = Ref<Macrostructure>{id + "Space"}, .steps = {std::move(step)}});
  return Operand{Operand::Kind::part, id};
}

std::optional<Operand> DocumentMaker::moved(Index node, const Box3& region) {
  const Instruction& at = word(node);
  const auto& n = at.numbers;
  const auto inner = operand(below(node), before(at, region));
  if (!inner) return std::nullopt;
  const std::string id = name(node), part = *part_of(*inner, inner->id + "Part");
  if (at.verb == Verb::mirror || (at.verb == Verb::scale && !has_positive_factors(at))) {
    number(id + "X", n[0]), number(id + "Y", n[1]), number(id + "Z", n[2]);
    const bool is_mirror = at.verb == Verb::mirror || n[0] * n[1] * n[2] < 0;
    Apply step{.part = Ref<Part>{part}};
    step.placement = Placement{.matrix = {at.verb == Verb::mirror ? mirror_matrix(id) : scale_matrix(id)}};
    if (is_mirror) step.placement->mirror = true;
    document_.parts.items.push_back({.id = {id}, .steps = {std::move(step)}});
    return Operand{Operand::Kind::part, id};
  }
  UnitCell cell{.id = {id}, .body = PartBody{.part = {part}}};
  Pattern pattern;
  place_once(pattern);
  const auto x = [&] { return number(id + "X", n[0]); };
  const auto y = [&] { return number(id + "Y", n[1]); };
  const auto z = [&] { return number(id + "Z", n[2]); };
  if (at.verb == Verb::move)
    pattern.instructions.push_back(TranslateInstruction{.x = x(), .y = y(), .z = z()});
  else if (at.verb == Verb::rotate)
    pattern.instructions.push_back(
        RotateInstruction{.x = x(), .y = y(), .z = z(), .angle = number(id + "Angle", n[3])});
  else if (at.verb == Verb::orient && n[0] == 0 && n[1] == 0 && n[2] < 0)  // half a turn about x
    pattern.instructions.push_back(
        RotateInstruction{.x = {"1"}, .y = {"0"}, .z = {"0"}, .angle = {format_number(std::numbers::pi)}});
  else if (at.verb == Verb::orient)
    pattern.instructions.push_back(OrientInstruction{.x = x(), .y = y(), .z = z()});
  else if (n[0] == n[1] && n[1] == n[2])
    pattern.instructions.push_back(ScaleInstruction{.factor = number(id + "Factor", n[0])});
  else
    pattern.instructions.push_back(ScaleInstruction{.x = x(), .y = y(), .z = z()});
  return add_pattern(std::move(cell), std::move(pattern), id);
}

std::optional<Operand> DocumentMaker::repeated(Index node, const Box3& region) {
  const auto& n = word(node).numbers;
  const std::string id = name(node);
  const Box3 roomy = with_room(region);
  Box3 once, shifted = region;  // cells begin half a step before the origin
  std::array<Expression, 3> steps;
  for (std::size_t a = 0; a < 3; ++a) {
    const bool repeats = n[a] > 0;
    const double half = repeats ? n[a] / 2 : std::max(std::abs(roomy.min[a]), std::abs(roomy.max[a]));
    once.min[a] = -half, once.max[a] = half;
    shifted.max[a] += half;
    steps[a] = repeats ? number(id + "XYZ"[a], n[a]) : Expression{format_number(2 * half)};
  }
  const auto inner = operand(below(node), once);
  if (!inner) return std::nullopt;
  UnitCell cell{.id = {id}, .clip_to_box = true, .body = PartBody{.part = {*part_of(*inner, inner->id + "Part")}}};
  const auto half = [&](std::size_t a) { return Expression{"-" + steps[a].text + "/2"}; };
  cell.box = CellBox{.x = half(0), .y = half(1), .z = half(2), .dx = steps[0], .dy = steps[1], .dz = steps[2]};
  Pattern pattern;
  fill(pattern, shifted, steps);
  for (std::size_t a = 0; a < 3; ++a)  // one cell that holds the region
    if (!(n[a] > 0)) pattern.fill->ranges[a].from = {"0"}, pattern.fill->ranges[a].to = steps[a];
  return add_pattern(std::move(cell), std::move(pattern), id);
}

std::optional<Document> document_of(const Program& program, const Box3& box, const std::filesystem::path& folder,
                                    DiagnosticSink& sink) {
  return DocumentMaker(program, folder, sink).make(program, box);
}

}  // namespace meso::sdf
