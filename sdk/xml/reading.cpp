// SPDX-License-Identifier: Apache-2.0
#include "reading.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "characters.hpp"
#include "meso/base/xml_text.hpp"
#include "meso/expr/nearest.hpp"
#include "write_text.hpp"

namespace meso::xml {
namespace {

std::string named(std::string_view text) { return std::string(text); }

std::string suggestion(std::string_view meant, std::string_view open, std::string_view close) {
  if (meant.empty()) return {};
  return "; did you mean " + named(open) + named(meant) + named(close) + "?";
}

}  // namespace

std::optional<Trivia> trivia_of(const pugi::xml_node& node) {
  if (node.type() == pugi::node_comment)
    return Trivia{Trivia::Kind::comment, with_lf("<!--" + std::string(node.value()) + "-->")};
  if (node.type() != pugi::node_pi) return std::nullopt;
  const std::string value = node.value();
  return Trivia{Trivia::Kind::instruction,
                with_lf("<?" + std::string(node.name()) + (value.empty() ? "" : " ") + value + "?>")};
}

ElementId Reading::add(const Node& n, std::string path) {
  const ScannedElement& e = element(n);
  SourceMap::ElementPlace place{.path = std::move(path), .offset = e.offset, .length = e.tag_length, .attributes = {}};
  place.attributes.reserve(e.attribute_count);
  const auto offset_of = [&](std::string_view part) { return static_cast<std::size_t>(part.data() - text_.data()); };
  for (std::uint32_t i = 0; i < e.attribute_count; ++i) {
    const ScannedAttribute& a = attribute(n, i);
    place.attributes.push_back({named(a.name.text), offset_of(a.name.text), offset_of(a.value), a.value.size()});
  }
  return source_.add(std::move(place));
}

void Reading::report(Code code, std::string path, std::string_view where, std::vector<std::string> args) {
  const auto offset = static_cast<std::size_t>(where.data() - text_.data());
  for (std::string& a : args) a = shortened(a);
  sink_.report(
      {.code = code, .where = source_.span_at(offset, where.size()), .path = std::move(path), .args = std::move(args)});
}

void Reading::report_tag(Code code, std::string path, const Node& n, std::vector<std::string> args) {
  const ScannedElement& e = element(n);
  report(code, std::move(path), text_.substr(e.offset, e.tag_length), std::move(args));
}

// What is written has the format as its default namespace and the root's prefixes; anything else that was in force
// must travel with the content that uses it.
bool Reading::needs_declaration(std::uint32_t binding, std::uint32_t element) const {
  const Binding& b = scan_.bindings[binding];
  if (b.namespace_number == xml_namespace || b.element >= element) return false;
  if (b.prefix.empty()) return b.namespace_number != format_namespace;
  return b.element != 0 || b.namespace_number == format_namespace;
}

std::string Reading::foreign_text(std::uint32_t scanned) const {
  const ScannedElement& e = scan_.elements[scanned];
  std::set<std::uint32_t> needed;
  bool plain = false;  // a name without prefix where no default namespace is in force
  const auto look_at = [&](const ScannedName& name, bool is_element) {
    if (name.space == xmlns_namespace) return;
    if (name.binding == ScannedName::unbound)
      plain = plain || is_element;
    else if (needs_declaration(name.binding, scanned))
      needed.insert(name.binding);
  };
  for (std::uint32_t i = scanned; i < e.next; ++i) {
    const ScannedElement& inner = scan_.elements[i];
    look_at(inner.name, true);
    for (std::uint32_t k = 0; k < inner.attribute_count; ++k)
      look_at(scan_.attributes[inner.first_attribute + k].name, false);
  }
  const std::size_t name_end = e.offset + 1 + e.name.text.size();
  std::string out(text_.substr(e.offset, name_end - e.offset));
  if (plain) out += " xmlns=\"\"";
  for (const std::uint32_t i : needed) {
    const Binding& b = scan_.bindings[i];
    out += (b.prefix.empty() ? " xmlns" : " xmlns:" + named(b.prefix)) + "=\"" + escaped_attribute(b.uri) + '"';
  }
  return with_lf(out + named(text_.substr(name_end, e.end - name_end)));
}

std::vector<ForeignAttribute> Reading::foreign_attributes(const Node& n) const {
  std::vector<ForeignAttribute> declarations, others;
  std::set<std::uint32_t> declared;
  for (std::uint32_t i = 0; i < element(n).attribute_count; ++i) {
    const ScannedAttribute& a = attribute(n, i);
    const bool prefixed = a.name.local_offset > 0;
    if (a.name.space == xmlns_namespace) {
      const std::string uri = normalized_attribute_value(a.value);
      if (n.scanned == 0 && prefixed && uri != meso_namespace) declarations.push_back({named(a.name.text), uri});
    } else if (prefixed && a.name.space != format_namespace) {
      const Binding& b = scan_.bindings[a.name.binding];
      const bool own = n.scanned != 0 && b.element == n.scanned;
      if ((own || needs_declaration(a.name.binding, n.scanned)) && declared.insert(a.name.binding).second)
        declarations.push_back({"xmlns:" + named(b.prefix), b.uri});
      others.push_back({named(a.name.text), normalized_attribute_value(a.value)});
    }
  }
  declarations.insert(declarations.end(), others.begin(), others.end());
  return declarations;
}

ElementScope::ElementScope(Reading& reading, const Node& node, const ElementShape& shape, std::string path)
    : reading_(reading), node_(node), shape_(shape), path_(std::move(path)), filled_(shape.slots.size()) {
  check_attributes();
  collect_children();
}

const ScannedAttribute* ElementScope::find_attribute(std::string_view name, pugi::xml_attribute& tree) const {
  for (std::uint32_t i = 0; i < reading_.element(node_).attribute_count; ++i) {
    const ScannedAttribute& a = reading_.attribute(node_, i);
    if (a.name.space != no_namespace || a.name.text != name) continue;
    tree = node_.tree.first_attribute();
    for (std::uint32_t k = 0; k < i; ++k) tree = tree.next_attribute();
    return &a;
  }
  return nullptr;
}

void ElementScope::report_value(const ScannedAttribute& attribute, Code code, std::vector<std::string> args) {
  reading_.report(code, path_ + "/@" + named(attribute.name.text), attribute.value, std::move(args));
}

void ElementScope::check_attributes() {
  const std::string_view element = reading_.element(node_).name.local();
  std::set<std::string_view> meant;  // by a mistyped name: not missing as well
  for (std::uint32_t i = 0; i < reading_.element(node_).attribute_count && !reading_.full(); ++i) {
    const ScannedName& name = reading_.attribute(node_, i).name;
    const auto& known = shape_.attributes;
    if (name.space == no_namespace && std::ranges::find(known, name.text, &AttributeShape::name) != known.end())
      continue;
    if (name.space != no_namespace && name.space != format_namespace) continue;
    std::vector<std::string_view> names;
    for (const AttributeShape& a : known) names.push_back(a.name);
    const std::string_view near = expr::nearest(name.text, names);
    meant.insert(near);
    reading_.report(Code::attribute_unknown, path_ + "/@" + named(name.text), name.text,
                    {named(element), named(name.text), suggestion(near, "'", "'")});
  }
  pugi::xml_attribute tree;
  for (const AttributeShape& a : shape_.attributes) {
    if (a.required && !meant.contains(a.name) && find_attribute(a.name, tree) == nullptr)
      reading_.report_tag(Code::attribute_missing, path_, node_, {named(element), named(a.name)});
  }
}

void ElementScope::collect_children() {
  std::vector<Trivia> pending;
  Node child{{}, node_.scanned + 1};
  for (child.tree = node_.tree.first_child(); child.tree; child.tree = child.tree.next_sibling()) {
    if (auto trivia = trivia_of(child.tree)) {
      pending.push_back(std::move(*trivia));
    } else if (child.tree.type() == pugi::node_element) {
      add_child(child, pending);
      child.scanned = reading_.element(child).next;
    } else if (shape_.has_text) {
      text_ += child.tree.value();
    }
  }
  trailing_ = std::move(pending);
  const ScannedElement& e = reading_.element(node_);
  if (!shape_.has_text && !e.text.empty())
    reading_.report(Code::text_unexpected, path_, e.text, {named(e.text), named(e.name.local())});
  if (shape_.any_order)
    std::stable_sort(children_.begin(), children_.end(),
                     [](const Child& a, const Child& b) { return a.slot < b.slot; });
}

void ElementScope::add_child(const Node& child, std::vector<Trivia>& pending) {
  const ScannedName& name = reading_.element(child).name;
  const auto parent = [this] { return named(reading_.element(node_).name.local()); };
  const auto child_path = [&] { return path_ + "/" + named(name.local()); };
  if (name.space == no_namespace) {
    reading_.report_tag(Code::element_no_namespace, child_path(), child, {named(name.text)});
    return;
  }
  if (name.space != format_namespace) {
    if (shape_.has_text)
      reading_.report_tag(Code::foreign_in_text, child_path(), child, {named(name.text), parent()});
    else
      pending.push_back({Trivia::Kind::foreign, reading_.foreign_text(child.scanned)});
    return;
  }
  const auto slot =
      std::find_if(shape_.slots.begin(), shape_.slots.end(), [&](const Slot& s) { return s.has(name.local()); });
  if (slot == shape_.slots.end()) return report_unknown(child);
  const auto index = static_cast<std::size_t>(slot - shape_.slots.begin());
  const bool once = slot->kind == SlotKind::single || slot->kind == SlotKind::choice;
  if (once && filled_[index] && slot->alternatives.size() == 1)
    reading_.report_tag(Code::element_repeated, child_path(), child, {named(name.local()), parent()});
  else if (once && filled_[index]) {
    std::string list;
    for (const Alternative& a : slot->alternatives) list += (list.empty() ? "<" : ", <") + named(a.name) + ">";
    reading_.report_tag(Code::element_choice, child_path(), child, {named(name.local()), parent(), list});
  } else if (index < current_slot_ && !shape_.any_order) {
    reading_.report_tag(Code::element_order, child_path(), child, {named(name.local()), named(current_name_)});
  }
  filled_[index] = true;
  if (index >= current_slot_) {
    current_slot_ = index;
    current_name_ = name.local();
  }
  const auto alternative = std::find_if(slot->alternatives.begin(), slot->alternatives.end(),
                                        [&](const Alternative& a) { return a.name == name.local(); });
  children_.push_back(
      {child, index, static_cast<std::size_t>(alternative - slot->alternatives.begin()), std::exchange(pending, {})});
}

void ElementScope::report_unknown(const Node& child) {
  if (reading_.full()) return;
  std::vector<std::string_view> names;
  for (const Slot& s : shape_.slots)
    for (const Alternative& a : s.alternatives) names.push_back(a.name);
  const std::string_view name = reading_.element(child).name.local();
  reading_.report_tag(
      Code::element_unknown, path_ + "/" + named(name), child,
      {named(name), named(reading_.element(node_).name.local()), suggestion(expr::nearest(name, names), "<", ">")});
}

}  // namespace meso::xml
