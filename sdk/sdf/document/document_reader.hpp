// SPDX-License-Identifier: Apache-2.0
#pragma once
// Words of a document, part by part. Parts and bodies: read_document.cpp; patterns of parts: read_patterns.cpp; unit
// cells and their levels: read_cells.cpp.

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "meso/sdf_document/words_and_documents.hpp"

namespace meso::sdf {

/// Puts the words of what it reads behind those that are there; false after a fault.
class DocumentReader {
 public:
  /// Whether to go on behind what is no word, for the sake of all others.
  enum class Faults { first, all };
  DocumentReader(const eval::Evaluation& evaluation, Faults faults) : evaluation_(evaluation), wanted_(faults) {}

  std::optional<Program> read(const std::string& part);
  [[nodiscard]] const std::vector<WhyNot>& faults() const { return faults_; }

 private:
  bool part(const Part& part, const Box3& region);
  bool step(const Part& part, const Apply& apply, const Box3& region, bool is_first);
  bool placed_part(const Apply& apply, const Box3& region);
  bool macrostructure(const std::string& id);
  bool csg(const CsgNode& node);
  template <class Transform>
  bool inner(const Transform& transform) {
    if (transform.operands.size() != 1) return no("a transform of several bodies");
    return csg(transform.operands[0]);
  }
  bool pattern(const Pattern& pattern, const Box3& region);
  bool moved_part(const PartBody& body, const Pattern& pattern, const Box3& region);
  bool bent_part(const UnitCell& cell, const Pattern& pattern, const Box3& region);
  bool repeated_part(const UnitCell& cell, const PartBody& body, const Pattern& pattern, const Box3& region);
  bool struts(const UnitCell& cell, const Pattern& pattern, const Box3& region);
  bool surface(const UnitCell& cell, const ImplicitBody& body, const Pattern& pattern, const Box3& region);
  bool formula(const UnitCell& cell, const ImplicitBody& body, const Pattern& pattern, const Box3& region);
  bool blended_surfaces(const UnitCell& cell, const ImplicitBody& body, const Pattern& pattern, const Box3& region);
  bool leaf(const UnitCell& cell, const std::string& field);
  /// `divisor`: the text that levels of a scaled surface are divided by.
  bool levels(const UnitCell& cell, const ImplicitBody& body, const Pattern& pattern, const std::string& divisor);

  void push(Verb verb, std::initializer_list<double> numbers = {}, std::string text = {}) {
    Instruction made{.verb = verb, .text = std::move(text)};
    std::copy(numbers.begin(), numbers.end(), made.numbers.begin());
    words_.push_back(std::move(made));
  }
  bool no(std::string why) {
    const auto is_same = [&](const WhyNot& known) { return known.element == where_ && known.why == why; };
    if (faults_.empty() || (wanted_ == Faults::all && std::ranges::none_of(faults_, is_same)))
      faults_.push_back({where_, std::move(why)});
    return false;
  }
  /// After a fault: whether to look at what stands beside it.
  [[nodiscard]] bool looks_on() const { return wanted_ == Faults::all; }
  double value(const Expression& expression) {
    DiagnosticSink unheard;
    const auto v = evaluation_.value(expression, {}, "value", unheard);
    if (!v) no("'" + expression.text + "' is no number of the document");
    return v.value_or(1);
  }
  double value(const std::optional<Expression>& expression, double absent) {
    return expression ? value(*expression) : absent;
  }
  std::optional<Box3> box_of(const CellBox& box) {
    const std::size_t before = faults_.size();
    const Vec3 corner{value(box.x, 0), value(box.y, 0), value(box.z, 0)};
    const Vec3 size{value(box.dx), value(box.dy), value(box.dz)};
    return faults_.size() == before ? std::optional(Box3{corner, corner + size}) : std::nullopt;
  }
  static bool stands_once(const Pattern& pattern) {
    return pattern.list && pattern.list->places.size() == 1 && pattern.list->places[0].at.text == "0, 0, 0";
  }
  /// Cells of this size side by side over the region.
  bool fills(const Pattern& pattern, const Box3& region, Vec3 size);
  /// The first and one after the last of a range's whole numbers.
  std::pair<double, double> counts(const FillRange& range) {
    const double step = value(range.step);
    constexpr double whole = 1e-9;  // steps fit within this
    return {std::ceil(value(range.from) / step - whole), std::floor(value(range.to) / step + whole)};
  }
  /// A number, or a formula of the words' x, y, z.
  struct Level {
    double number = 0;
    std::string formula{};
  };
  std::optional<Level> level(const UnitCell& cell, const Pattern& pattern, const Expression& expression,
                             const std::string& divisor);
  bool blend_by(const Level& weight);
  std::optional<std::string> in_words(const UnitCell& cell, const Pattern& pattern, const std::string& text,
                                      std::string_view axis_prefix);
  /// Values at points are all that happens to the cells.
  bool only_sets_at_points(const Pattern& pattern);
  /// What a surface's coordinates are multiplied by in a cell.
  std::optional<Vec3> scale_of(const UnitCell& cell, const Pattern& pattern, const Box3& region,
                               std::string_view surface);

  const eval::Evaluation& evaluation_;
  Faults wanted_;
  std::vector<WhyNot> faults_;
  std::string where_;
  std::vector<Instruction> words_;
};

/// Null if there is none of that id.
template <class T>
const T* find(const Section<T>& all, const std::string& id) {
  const auto found = std::ranges::find(all, id, [](const T& one) { return one.id.text; });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace meso::sdf
