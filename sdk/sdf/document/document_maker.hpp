// SPDX-License-Identifier: Apache-2.0
#pragma once
// Makes a document of a tree of solids, operand by operand: what stands in the document already is not made again.
// Bodies of primitives and files: make_bodies.cpp; unit cells and their levels: make_cells.cpp; blends of shares:
// make_blends.cpp; what is bent: make_bends.cpp; the rest: make_document.cpp.

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "meso/base/number.hpp"
#include "meso/sdf/solid_tree.hpp"
#include "meso/sdf_document/words_and_documents.hpp"
#include "region.hpp"

namespace meso::sdf {

using Index = std::uint32_t;

inline bool is_move(Verb verb) {
  return verb == Verb::move || verb == Verb::scale || verb == Verb::rotate || verb == Verb::orient ||
         verb == Verb::mirror;
}
inline bool is_bend(Verb verb) { return verb == Verb::cylindrical || verb == Verb::spherical || verb == Verb::helix; }
inline bool is_level(Verb verb) {
  return verb == Verb::offset || verb == Verb::shell || verb == Verb::eccentric_shell || verb == Verb::density ||
         verb == Verb::complement;
}
inline bool has_positive_factors(const Instruction& scale) {
  return scale.numbers[0] > 0 && scale.numbers[1] > 0 && scale.numbers[2] > 0;
}

/// A solid as the operand of a step.
struct Operand {
  enum class Kind { macrostructure, pattern, part } kind{};
  std::string id;
};

/// The same solid in other words: levels of cells first, then moves, bends and joints, as a document has them. Words
/// that nobody wrote are put into `made_up`, which must outlive the tree.
SolidTree levels_first(const SolidTree& tree, std::deque<Instruction>& made_up);

class DocumentMaker {
 public:
  DocumentMaker(const Program& program, const std::filesystem::path& folder, DiagnosticSink& sink)
      : tree_(levels_first(solid_tree(program), made_up_)), folder_(folder), sink_(sink) {}

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
  std::optional<Operand> bent(Index node, const Box3& region);
  std::string sheared(Index node, const std::string& part);
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

  /// A surface, perhaps scaled, and its share; and of blends of these, in order.
  struct Share {
    const Instruction* surface = nullptr;
    double scale = 1;
    Index density = 0, blend = 0;  ///< that which joins it to those before
  };
  bool fills_a_share(Index node) const;
  bool add_shares(Index node, std::vector<Share>& shares);
  std::optional<Operand> blended_cells(Index node, const Box3& region);
  /// A parameter of the cell, whose value is a formula of the point.
  static Expression set_at_points(UnitCell& cell, Pattern& pattern, const std::string& id, const std::string& text);

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

  std::deque<Instruction> made_up_;  // before the tree that points to them
  SolidTree tree_;
  const std::filesystem::path& folder_;
  DiagnosticSink& sink_;
  Document document_;
  std::map<std::string, std::string> parts_;  ///< of operands that are no parts
  std::map<Index, int> visits_;               ///< of nodes that are needed in several regions
  std::map<std::pair<Index, std::array<double, 6>>, Operand> made_;
  std::size_t depth_ = 0;
};

}  // namespace meso::sdf
