// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "leaf_formulas.hpp"
#include "meso/base/number.hpp"
#include "meso/expr/expression.hpp"
#include "meso/implicit/surfaces.hpp"
#include "meso/sdf/solid_tree.hpp"
#include "meso/sdf_document/words_and_documents.hpp"
#include "region.hpp"

namespace meso::sdf {
namespace {

using Index = std::uint32_t;

bool is_move(Verb verb) {
  return verb == Verb::move || verb == Verb::scale || verb == Verb::rotate || verb == Verb::orient ||
         verb == Verb::mirror;
}
bool is_level(Verb verb) {
  return verb == Verb::offset || verb == Verb::shell || verb == Verb::eccentric_shell || verb == Verb::density ||
         verb == Verb::complement;
}
bool has_positive_factors(const Instruction& scale) {
  return scale.numbers[0] > 0 && scale.numbers[1] > 0 && scale.numbers[2] > 0;
}

/// A solid as the operand of a step.
struct Operand {
  enum class Kind { macrostructure, pattern, part } kind{};
  std::string id;
};

/// Rounded outwards, with room to spare: nothing is cut there.
Box3 with_room(const Box3& region) {
  Box3 box;
  for (std::size_t a = 0; a < 3; ++a) {
    const double size = region.max[a] - region.min[a];
    const double digits = std::floor(std::log10(size)) - 1, step = std::pow(10, std::abs(digits));
    const auto rounded = [&](double steps) { return digits < 0 ? steps / step : steps * step; };
    const auto in_steps = [&](double v) { return digits < 0 ? v * step : v / step; };
    box.min[a] = rounded(std::floor(in_steps(region.min[a])) - 1);
    box.max[a] = rounded(std::ceil(in_steps(region.max[a])) + 1);
  }
  return box;
}

bool is_rigid(Verb verb) { return is_move(verb) && verb != Verb::scale; }

/// A level of a solid that was moved is a move of the level: the same function. Cells have levels, moves stand outside.
SolidTree moves_last(const SolidTree& tree) {
  SolidTree result;
  std::vector<Index> number;
  const auto add = [&](const Instruction* word, std::vector<Index> of) {
    result.nodes.push_back({word, std::move(of)});
    return static_cast<Index>(result.nodes.size() - 1);
  };
  for (const SolidTree::Node& node : tree.nodes) {
    std::vector<Index> of;
    for (const Index part : node.of) of.push_back(number[part]);
    std::vector<const Instruction*> moves;
    if (is_level(node.made_by->verb) && node.made_by->text.empty() && node.made_by->verb != Verb::density)
      while (is_rigid(result.nodes[of[0]].made_by->verb)) {
        moves.push_back(result.nodes[of[0]].made_by);
        of[0] = result.nodes[of[0]].of[0];
      }
    Index made = add(node.made_by, std::move(of));
    for (std::size_t i = moves.size(); i-- > 0;) made = add(moves[i], {made});
    number.push_back(made);
  }
  return result;
}

class DocumentMaker {
 public:
  DocumentMaker(const Program& program, const std::filesystem::path& folder, DiagnosticSink& sink)
      : tree_(moves_last(solid_tree(program))), folder_(folder), sink_(sink) {}

  std::optional<Document> make(const Program& program, const Box3& box);

 private:
  // Each puts what it needs into the document; nothing after a fault.
  std::optional<Operand> operand(Index node, const Box3& region);
  std::optional<Operand> new_operand(Index node, const Box3& region);
  std::optional<Operand> macrostructure(Index node);
  std::optional<Operand> joined(Index node, const Box3& region);
  std::optional<Operand> complement(Index node, const Box3& region);
  std::optional<Operand> moved(Index node, const Box3& region);
  std::optional<Operand> repeated(Index node, const Box3& region);
  std::optional<Operand> strut(Index node, const Box3& region, const Instruction* scale);
  std::optional<Operand> file(Index node);
  /// A leaf or a blend of leaves, perhaps scaled, and what was done to its levels, inmost first.
  std::optional<Operand> cell(Index node, const Box3& region);

  struct Chain {
    Index leaf = 0;
    const Instruction* scale = nullptr;
    std::vector<const Instruction*> levels{}, moves{};  ///< inmost first
    std::vector<Index> levels_nodes{};
  };
  std::optional<Chain> chain_of(Index node);
  bool set_levels(const Chain& chain, UnitCell& cell, ImplicitBody& body, Pattern& pattern, bool is_periodic);
  std::optional<std::string> field_text(Index node, UnitCell& cell);
  bool add_blends(Index node, UnitCell& cell, ImplicitBody& body);

  std::optional<std::string> part_of(const Operand& operand, const std::string& name);
  std::optional<CsgNode> csg(Index node);
  bool is_csg(Index node) const;

  [[nodiscard]] const Instruction& word(Index node) const { return *tree_.nodes[node].made_by; }
  [[nodiscard]] Index below(Index node, std::size_t which = 0) const { return tree_.nodes[node].of[which]; }
  /// A name for what the word makes: its own, and its place in the line.
  [[nodiscard]] std::string name(Index node) const { return name(node, node); }
  [[nodiscard]] std::string name(Index node, Index called) const {
    std::string result;
    const Instruction& at = word(called);
    const bool has_name = at.verb == Verb::surface || at.verb == Verb::strut;
    const std::string word_text = has_name ? at.text : std::string(word_of(at.verb));
    bool raise = false;
    for (const char c : word_text) {
      const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
      if (plain) result += raise && c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c;
      raise = !plain;
    }
    const auto visits = visits_.find(node);
    const bool is_again = visits != visits_.end() && visits->second > 1;
    return result + std::to_string(node + 1) + (is_again ? "Copy" + std::to_string(visits->second) : "");
  }
  /// A parameter of the document; its name.
  Expression number(const std::string& id, double value) {
    const bool is_new = std::ranges::find(document_.parameters, id, [](const Parameter& p) { return p.id.text; }) ==
                        document_.parameters.end();
    if (is_new) document_.parameters.items.push_back({.id = {id}, .value = {format_number(value)}});
    return {id};
  }
  std::nullopt_t fault(Index node, std::string why) { return fault(word(node), std::move(why)); }
  std::nullopt_t fault(const Instruction& at, std::string why) {
    Diagnostic d{.code = Code::sdf_not_a_document,
                 .args = {at.word.text.empty() ? std::string(word_of(at.verb)) : at.word.text, std::move(why)}};
    point_at(d, at.word);
    sink_.report(std::move(d));
    return std::nullopt;
  }

  Operand add_pattern(UnitCell cell, Pattern pattern, const std::string& id) {
    pattern.id = {id + "Cells"};
    pattern.unit_cell = {cell.id.text};
    document_.unit_cells.items.push_back(std::move(cell));
    document_.patterns.items.push_back(std::move(pattern));
    return {Operand::Kind::pattern, id + "Cells"};
  }
  static void place_once(Pattern& pattern) { pattern.list = PlacementList{.places = {{.at = {"0, 0, 0"}}}}; }
  static CellBox cell_box(const Box3& box) {
    const auto text = [](double v) { return Expression{format_number(v)}; };
    return {.x = text(box.min.x),
            .y = text(box.min.y),
            .z = text(box.min.z),
            .dx = text(box.max.x - box.min.x),
            .dy = text(box.max.y - box.min.y),
            .dz = text(box.max.z - box.min.z)};
  }
  /// Whole cells over all of the region, whatever their size.
  static void fill(Pattern& pattern, const Box3& region, const std::array<Expression, 3>& steps) {
    const Box3 box = with_room(region);
    Fill over;
    for (std::size_t a = 0; a < 3; ++a)
      over.ranges.push_back({.axis = {std::string(1, "xyz"[a])},
                             .from = {format_number(box.min[a]) + " - " + steps[a].text},
                             .to = {format_number(box.max[a]) + " + " + steps[a].text},
                             .step = steps[a]});
    pattern.fill = std::move(over);
  }

  SolidTree tree_;
  const std::filesystem::path& folder_;
  DiagnosticSink& sink_;
  Document document_;
  std::map<std::string, std::string> parts_;  ///< of operands that are no parts
  std::map<Index, int> visits_;               ///< of nodes that are needed in several regions
  std::map<std::pair<Index, std::array<double, 6>>, Operand> made_;
  std::size_t depth_ = 0;
};

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
      return fault(node, "documents bend cells, not solids; write a pattern with mapping=\"conformal\"");
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

bool DocumentMaker::is_csg(Index node) const {
  for (;; node = below(node)) {
    const Instruction& at = word(node);
    const bool is_primitive =
        at.verb == Verb::ball || at.verb == Verb::box || at.verb == Verb::cone || at.verb == Verb::torus;
    if (is_primitive) return true;
    const bool is_placed = at.verb == Verb::move || at.verb == Verb::rotate ||
                           (at.verb == Verb::scale && has_positive_factors(at)) || at.verb == Verb::mirror;
    if (!is_placed) return false;
  }
}

std::optional<CsgNode> DocumentMaker::csg(Index node) {
  const Instruction& at = word(node);
  const auto& n = at.numbers;
  const std::string id = name(node);
  const auto operands = [&](auto made) -> std::optional<CsgNode> {
    auto inner = csg(below(node));
    if (!inner) return std::nullopt;
    made.operands.push_back(std::move(*inner));
    return CsgNode{std::move(made)};
  };
  switch (at.verb) {
    case Verb::ball:
      return CsgNode{SpherePrimitive{.radius = {"1"}}};
    case Verb::box: {
      BoxPrimitive box{.x = Expression{"-1"}, .y = Expression{"-1"}, .z = Expression{"-1"}};
      box.dx = box.dy = box.dz = Expression{"2"};
      return CsgNode{box};
    }
    case Verb::cone: {
      const Expression zero{"0"}, height = number(id + "Height", n[2]);
      if (n[0] == n[1])
        return CsgNode{CylinderPrimitive{.x1 = zero,
                                         .y1 = zero,
                                         .z1 = zero,
                                         .x2 = zero,
                                         .y2 = zero,
                                         .z2 = height,
                                         .radius = number(id + "Radius", n[0])}};
      return CsgNode{ConePrimitive{.x1 = zero,
                                   .y1 = zero,
                                   .z1 = zero,
                                   .x2 = zero,
                                   .y2 = zero,
                                   .z2 = height,
                                   .radius1 = number(id + "Bottom", n[0]),
                                   .radius2 = number(id + "Top", n[1])}};
    }
    case Verb::torus:
      return CsgNode{
          TorusPrimitive{.major_radius = number(id + "Ring", n[0]), .minor_radius = number(id + "Tube", n[1])}};
    case Verb::move:
      return operands(
          CsgTranslate{.x = number(id + "X", n[0]), .y = number(id + "Y", n[1]), .z = number(id + "Z", n[2])});
    case Verb::rotate:
      return operands(CsgRotate{.x = number(id + "X", n[0]),
                                .y = number(id + "Y", n[1]),
                                .z = number(id + "Z", n[2]),
                                .angle = number(id + "Angle", n[3])});
    case Verb::mirror:
      number(id + "X", n[0]), number(id + "Y", n[1]), number(id + "Z", n[2]);
      return operands(CsgTransform{.matrix = {mirror_matrix(id)}, .mirror = true});
    default:
      break;
  }
  if (n[0] == n[1] && n[1] == n[2]) return operands(CsgScale{.factor = number(id + "Factor", n[0])});
  return operands(CsgScale{.x = number(id + "X", n[0]), .y = number(id + "Y", n[1]), .z = number(id + "Z", n[2])});
}

std::optional<Operand> DocumentMaker::macrostructure(Index node) {
  auto body = csg(node);
  if (!body) return std::nullopt;
  Macrostructure made{.id = {name(node) + "Body"}, .body = CsgBody{.operands = {std::move(*body)}}};
  const std::string id = made.id.text;
  document_.macrostructures.items.push_back(std::move(made));
  return Operand{Operand::Kind::macrostructure, id};
}

std::optional<Operand> DocumentMaker::file(Index node) {
  std::error_code error;
  const auto path = std::filesystem::absolute(word(node).text, error);
  const auto from = std::filesystem::absolute(folder_.empty() ? "." : folder_, error).lexically_normal();
  const auto href = path.lexically_normal().lexically_relative(from);
  if (href.empty() || *href.begin() == "..") return fault(node, "the mesh does not lie in the document's folder");
  Macrostructure made{.id = {name(node) + "Body"},
                      .body = ImportBody{.href = {href.generic_string()}, .unit = LengthUnit::millimeter}};
  const std::string id = made.id.text;
  document_.macrostructures.items.push_back(std::move(made));
  return Operand{Operand::Kind::macrostructure, id};
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
  Box3 once = with_room(region);
  std::array<Expression, 3> steps;
  for (std::size_t a = 0; a < 3; ++a) {
    if (!(n[a] > 0)) return fault(node, "a pattern of cells repeats them along all three axes");
    once.min[a] = -n[a] / 2, once.max[a] = n[a] / 2;
    steps[a] = number(id + "XYZ"[a], n[a]);
  }
  // Cells begin half a step before the origin.
  const Box3 shifted{region.min, region.max + 0.5 * Vec3{n[0], n[1], n[2]}};
  const auto inner = operand(below(node), once);
  if (!inner) return std::nullopt;
  UnitCell cell{.id = {id}, .clip_to_box = true, .body = PartBody{.part = {*part_of(*inner, inner->id + "Part")}}};
  const auto half = [&](std::size_t a) { return Expression{"-" + steps[a].text + "/2"}; };
  cell.box = CellBox{.x = half(0), .y = half(1), .z = half(2), .dx = steps[0], .dy = steps[1], .dz = steps[2]};
  Pattern pattern;
  fill(pattern, shifted, steps);
  return add_pattern(std::move(cell), std::move(pattern), id);
}

std::optional<Operand> DocumentMaker::strut(Index node, const Box3& region, const Instruction* scale) {
  const std::string id = name(node);
  double edge = 1;
  if (scale != nullptr) {
    edge = scale->numbers[0];
    if (scale->numbers[1] != edge || scale->numbers[2] != edge)
      return fault(*scale, "cells of struts have one edge; scale by one number");
  }
  const Expression cell_edge = number(id + "Edge", edge), radius = number(id + "Radius", word(node).numbers[0]);
  UnitCell cell{.id = {id}, .library = Name{word(node).text}};
  cell.parameters.push_back({.name = {"cellEdge"}, .value = cell_edge});
  cell.parameters.push_back({.name = {"strutRadius"}, .value = {radius.text + "*" + cell_edge.text}});
  Pattern pattern;
  fill(pattern, region, {cell_edge, cell_edge, cell_edge});
  return add_pattern(std::move(cell), std::move(pattern), id);
}

// Levels may change before and after a rigid move: it is the same function. Moves are taken out as the outermost.
std::optional<DocumentMaker::Chain> DocumentMaker::chain_of(Index node) {
  Chain chain;
  for (;; node = below(node)) {
    const Instruction& at = word(node);
    if (is_level(at.verb)) {
      if (!chain.moves.empty()) return std::nullopt;
      chain.levels.insert(chain.levels.begin(), &at);
      chain.levels_nodes.insert(chain.levels_nodes.begin(), node);
      continue;
    }
    if (at.verb == Verb::scale && has_positive_factors(at) && tree_.nodes[below(node)].of.empty()) {
      chain.scale = &at;
      continue;
    }
    if (!tree_.nodes[node].of.empty() && at.verb != Verb::blend) return std::nullopt;
    chain.leaf = node;
    return chain;
  }
}

bool DocumentMaker::set_levels(const Chain& chain, UnitCell& cell, ImplicitBody& body, Pattern& pattern,
                               bool is_periodic) {
  std::string factor;  // of levels that are taken of a scaled surface
  if (is_periodic && chain.scale != nullptr) factor = "/" + cell.box->dx.text;
  const auto value = [&](Index node, const std::string& suffix, double constant, const std::string& text,
                         const std::string& divided) -> Expression {
    const std::string id = name(node) + suffix;
    if (text.empty()) return {number(id, constant).text + divided};
    const std::string written = renamed(text, [](const std::string& used) {
      return used == "tau" ? std::optional<std::string>("(2*pi)") : std::nullopt;
    });
    if (!is_periodic) return {written};
    cell.parameters.push_back({.name = {id}, .value = {"0"}});
    pattern.instructions.push_back(
        SetInstruction{.parameter = {id},
                       .value = {renamed(written,
                                         [](const std::string& used) {
                                           const bool is_axis = used == "x" || used == "y" || used == "z";
                                           return is_axis ? std::optional("global." + used) : std::nullopt;
                                         })},
                       .at = SetAt::point});
    return {id + divided};
  };
  for (std::size_t i = 0; i < chain.levels.size(); ++i) {
    const Instruction& at = *chain.levels[i];
    const Index node = chain.levels_nodes[i];
    const bool is_last = i + 1 == chain.levels.size();
    const auto items = expr::split_list(at.text);
    const std::string first = at.text.empty() ? "" : std::string(items[0].text);
    if (at.verb == Verb::offset && i == 0) {
      body.isovalue = value(node, "Level", at.numbers[0], first, factor);
    } else if (at.verb == Verb::shell && is_last) {
      body.kind = ImplicitKind::shell;
      body.thickness = value(node, "Thickness", at.numbers[0], first, factor);
    } else if (at.verb == Verb::eccentric_shell && is_last && i == 0) {
      body.kind = ImplicitKind::eccentric_shell;
      body.lower = value(node, "Lower", at.numbers[0], first, factor);
      body.upper = value(node, "Upper", at.numbers[1], at.text.empty() ? "" : std::string(items[1].text), factor);
    } else if (at.verb == Verb::complement && is_last) {
      body.kind = ImplicitKind::exoskeleton;
    } else if (at.verb == Verb::density && is_last && i == 0 && is_periodic) {
      body.density = value(node, "Share", at.numbers[0], first, "");
    } else {
      fault(at, "a cell has one level and one kind; this comes on top of '" +
                    std::string(word_of(i == 0 ? word(chain.leaf).verb : chain.levels[i - 1]->verb)) + "'");
      return false;
    }
  }
  return true;
}

std::optional<std::string> DocumentMaker::field_text(Index node, UnitCell& cell) {
  const Instruction& at = word(node);
  const auto& n = at.numbers;
  if (at.verb == Verb::surface) return std::string(implicit::find_surface(at.text)->expression);
  if (at.verb == Verb::expression)
    return renamed(at.text, [](const std::string& used) {
      return used == "tau" ? std::optional<std::string>("(2*pi)") : std::nullopt;
    });
  const auto formulas = leaf_formulas();
  const auto found = std::ranges::find(formulas, at.verb, &LeafFormula::verb);
  if (found == formulas.end()) return fault(at, "a document has no formula of its distance, which a level needs");
  for (std::size_t i = 0; i < found->parameters.size(); ++i) {
    const std::string own(found->parameters[i]);
    std::string global = name(node) + own;
    global[global.size() - own.size()] = static_cast<char>(own[0] - 32);
    cell.parameters.push_back({.name = {own}, .value = number(global, n[i])});
  }
  if (at.verb == Verb::capsule) {
    if (n[0] == n[3] && n[1] == n[4] && n[2] == n[5]) return fault(at, "it has no length; write a ball");
    for (const char axis : {'X', 'Y', 'Z'})
      cell.parameters.push_back(
          {.name = {std::string("way") + axis}, .value = {std::string("to") + axis + " - from" + axis}});
    cell.parameters.push_back({.name = {"wayWay"}, .value = {"wayX^2 + wayY^2 + wayZ^2"}});
  }
  return std::string(found->field);
}

// The first of all is the body's function; each further one comes with its weight.
bool DocumentMaker::add_blends(Index node, UnitCell& cell, ImplicitBody& body) {
  const Instruction& at = word(node);
  if (at.verb != Verb::blend) {
    const auto field = field_text(node, cell);
    if (field) body.field = Expression{*field};
    return field.has_value();
  }
  const Index above = below(node, 1);
  if (!tree_.nodes[above].of.empty())
    return fault(above, "a blend in a document is of surfaces and expressions"), false;
  if (!add_blends(below(node), cell, body)) return false;
  const auto field = field_text(above, cell);
  if (!field) return false;
  const std::string weight = renamed(at.text, [](const std::string& used) {
    return used == "tau" ? std::optional<std::string>("(2*pi)") : std::nullopt;
  });
  body.blends.push_back({.field = Expression{*field}, .weight = {clamped(weight)}});
  return true;
}

std::optional<Operand> DocumentMaker::cell(Index node, const Box3& region) {
  const auto chain = chain_of(node);
  if (!chain) return fault(node, "in a document only cells have levels, before they are moved or joined");
  const Instruction& leaf = word(chain->leaf);
  const std::string id = name(node, chain->leaf);
  UnitCell made{.id = {id}};
  ImplicitBody body;
  Pattern pattern;
  const bool is_periodic = leaf.verb == Verb::surface;
  if (leaf.verb == Verb::file || leaf.verb == Verb::strut)
    return fault(node, "in a document only surfaces, formulas and primitives have levels");
  if (is_periodic) {
    std::array<Expression, 3> edges;
    edges.fill({"1"});
    if (chain->scale != nullptr) {
      const auto& n = chain->scale->numbers;
      if (n[0] == n[1] && n[1] == n[2])
        edges.fill(number(id + "Edge", n[0]));
      else
        for (std::size_t a = 0; a < 3; ++a) edges[a] = number(id + "Edge" + "XYZ"[a], n[a]);
      if (!chain->levels.empty() && !(n[0] == n[1] && n[1] == n[2]))
        return fault(*chain->scale, "levels of a surface scaled by three factors cannot be said; scale last");
    }
    if (leaf.text == "q-star-hex") edges[1].text = "sqrt(3)*" + edges[1].text;
    made.box = CellBox{.dx = edges[0], .dy = edges[1], .dz = edges[2]};
    body.surface = leaf.text;
    fill(pattern, region, edges);
  } else {
    made.box = cell_box(with_room(region));
    place_once(pattern);
    if (!add_blends(chain->leaf, made, body)) return std::nullopt;
    if (chain->scale != nullptr) {
      const auto& n = chain->scale->numbers;
      if (n[0] != n[1] || n[1] != n[2])
        return fault(*chain->scale, "levels of a body scaled by three factors cannot be said; scale last");
      made.parameters.push_back({.name = {"scale"}, .value = number(id + "Scale", n[0])});
      body.field->text = scaled_field(body.field->text);
    }
  }
  if (!set_levels(*chain, made, body, pattern, is_periodic)) return std::nullopt;
  made.body = std::move(body);
  return add_pattern(std::move(made), std::move(pattern), name(node));
}

}  // namespace

std::optional<Document> document_of(const Program& program, const Box3& box, const std::filesystem::path& folder,
                                    DiagnosticSink& sink) {
  return DocumentMaker(program, folder, sink).make(program, box);
}

}  // namespace meso::sdf
