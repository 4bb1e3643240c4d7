// SPDX-License-Identifier: Apache-2.0
#pragma once
// What all element readers of one file share, and the part of reading an element that does not depend on its type:
// sorting its children into the slots of its shape, keeping comments and foreign content, reporting what does not fit.

#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "meso/model/source_map.hpp"
#include "scan.hpp"
#include "shape.hpp"

namespace meso::xml {

/// One element, seen by both passes.
struct Node {
  pugi::xml_node tree;
  std::uint32_t scanned = 0;
};

class Reading {
 public:
  Reading(const Scan& scan, SourceMap& source, DiagnosticSink& sink)
      : scan_(scan), source_(source), sink_(sink), text_(source.text()) {}

  [[nodiscard]] const Scan& scan() const { return scan_; }
  [[nodiscard]] const ScannedElement& element(const Node& n) const { return scan_.elements[n.scanned]; }
  [[nodiscard]] const ScannedAttribute& attribute(const Node& n, std::uint32_t i) const {
    return scan_.attributes[element(n).first_attribute + i];
  }
  /// Enters the element into the source map.
  ElementId add(const Node& n, std::string path);

  void report(Code code, std::string path, std::string_view where, std::vector<std::string> args);
  void report_tag(Code code, std::string path, const Node& n, std::vector<std::string> args);
  /// Nobody reads further messages: no work for them.
  [[nodiscard]] bool full() const { return sink_.truncated(); }

  /// A foreign element as it stands in the file, with the declarations it needs wherever it is moved.
  [[nodiscard]] std::string foreign_text(std::uint32_t scanned) const;
  /// Foreign attributes, behind the declarations they need.
  [[nodiscard]] std::vector<ForeignAttribute> foreign_attributes(const Node& n) const;

 private:
  [[nodiscard]] bool needs_declaration(std::uint32_t binding, std::uint32_t element) const;

  const Scan& scan_;
  SourceMap& source_;
  DiagnosticSink& sink_;
  std::string_view text_;
};

struct Child {
  Node node;
  std::size_t slot = 0;
  std::size_t alternative = 0;
  std::vector<Trivia> before;
};

/// One element while it is read. Children that fit no slot have been reported and left out; those of a root in any
/// order are grouped by slot.
class ElementScope {
 public:
  ElementScope(Reading& reading, const Node& node, const ElementShape& shape, std::string path);

  [[nodiscard]] Reading& reading() { return reading_; }
  [[nodiscard]] const Node& node() const { return node_; }
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] std::vector<Child>& children() { return children_; }
  [[nodiscard]] std::vector<Trivia>& trailing() { return trailing_; }
  [[nodiscard]] std::string& text() { return text_; }

  /// The attribute of this name in no namespace, or null.
  [[nodiscard]] const ScannedAttribute* find_attribute(std::string_view name, pugi::xml_attribute& tree) const;
  void report_value(const ScannedAttribute& attribute, Code code, std::vector<std::string> args);

 private:
  void check_attributes();
  void collect_children();
  void add_child(const Node& child, std::vector<Trivia>& pending);
  void report_unknown(const Node& child);
  void check_order(std::vector<Child>& all);

  Reading& reading_;
  Node node_;
  const ElementShape& shape_;
  std::string path_;
  std::vector<Child> children_;
  std::vector<Trivia> trailing_;
  std::string text_;
  std::size_t current_slot_ = 0;
  std::string_view current_name_;
  std::vector<bool> filled_;
};

/// Comments and processing instructions as written; null for other nodes.
[[nodiscard]] std::optional<Trivia> trivia_of(const pugi::xml_node& node);

}  // namespace meso::xml
