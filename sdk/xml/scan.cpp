// SPDX-License-Identifier: Apache-2.0
#include "scan.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "characters.hpp"
#include "namespaces.hpp"

namespace meso::xml {
namespace {

constexpr std::size_t npos = std::string_view::npos;

class Scanner {
 public:
  Scanner(std::string_view text, ScanLimits limits) : text_(text), limits_(limits), scope_(out_.bindings) {}

  std::variant<Scan, ScanFault> run() {
    if (!all()) return std::move(fault_);
    return std::move(out_);
  }

 private:
  // Every step answers false once a fault is noted; the first fault ends the scan, because what follows would be
  // guesses.
  bool all();
  bool declaration();
  bool markup();
  bool comment();
  bool instruction();
  bool cdata();
  bool characters();
  bool references(std::size_t first, std::size_t last);
  bool start_tag();
  bool attribute();
  bool end_tag();
  bool name(ScannedName& out, std::string_view expected);
  bool resolve_names(std::uint32_t element);
  bool declare_namespaces(std::uint32_t element);
  bool declare(const ScannedAttribute& a, std::uint32_t element);
  bool resolve(ScannedName& name, bool uses_default);
  bool distinct_attributes(const ScannedElement& e);
  void close(std::size_t end);
  void note_text(std::size_t first, std::size_t last);

  bool fail(Code code, std::size_t offset, std::size_t length, std::vector<std::string> args = {}) {
    fault_ = {code, offset, length, std::move(args), {}, {}};
    return false;
  }
  bool fail_syntax(std::string_view expected) {
    return fail(Code::xml_syntax, pos_, 1, {std::string(expected), shown(pos_)});
  }
  bool fail_cut(std::string what, std::size_t opened) {
    fail(Code::xml_truncated, text_.size(), 0, {std::move(what)});
    fault_.related_offset = opened;
    fault_.related_note = "opened here";
    return false;
  }
  [[nodiscard]] std::size_t offset_of(std::string_view part) const {
    return static_cast<std::size_t>(part.data() - text_.data());
  }
  /// The character at a place, as messages show it.
  [[nodiscard]] std::string shown(std::size_t at) const {
    if (at >= text_.size()) return "the end of the file";
    if (text_[at] == '\n' || text_[at] == '\r') return "the end of the line";
    return "'" + std::string(text_.substr(at, decode_utf8(text_, at).length)) + "'";
  }
  [[nodiscard]] bool at_end() const { return pos_ >= text_.size(); }
  [[nodiscard]] bool at(std::string_view what) const { return text_.substr(pos_, what.size()) == what; }
  /// The rest of the file is a beginning of `what`.
  [[nodiscard]] bool cut(std::string_view what) const {
    const std::string_view rest = text_.substr(pos_);
    return rest.size() < what.size() && what.starts_with(rest);
  }
  bool skip_space() {
    const std::size_t first = pos_;
    while (!at_end() && is_space(text_[pos_])) ++pos_;
    return pos_ > first;
  }
  bool add_node() {
    if (out_.elements.size() + out_.attributes.size() < limits_.max_nodes) return true;
    return fail(Code::xml_too_many_nodes, pos_, 1, {std::to_string(limits_.max_nodes)});
  }

  std::string_view text_;
  ScanLimits limits_;
  std::size_t pos_ = 0;
  Scan out_;
  NamespaceScope scope_;
  std::vector<const ScannedName*> names_;  ///< of one element, while they are compared
  std::vector<std::uint32_t> open_;        ///< elements whose end tag is still to come
  ScanFault fault_;
};

bool Scanner::all() {
  if (!declaration()) return false;
  // No more elements than '<' and no more attributes than '=': pages that stay unused cost nothing.
  const auto bound = [&](char c) {
    return std::min(static_cast<std::size_t>(std::count(text_.begin(), text_.end(), c)), limits_.max_nodes);
  };
  out_.elements.reserve(bound('<'));
  out_.attributes.reserve(bound('='));
  while (!at_end()) {
    if (!(text_[pos_] == '<' ? markup() : characters())) return false;
  }
  if (!open_.empty()) {
    const ScannedElement& e = out_.elements[open_.back()];
    return fail_cut("the element <" + std::string(e.name.text) + ">", e.offset);
  }
  return !out_.elements.empty() || fail(Code::xml_no_root, text_.size(), 0);
}

// <?xml version="1.0" encoding="UTF-8" standalone="yes"?>, the last two optional. The bytes have been read as UTF-8
// or, with a byte order mark, as UTF-16; any other name would mean that the text is not what its author wrote.
bool Scanner::declaration() {
  if (!at("<?xml") || (pos_ + 5 < text_.size() && !is_space(text_[5]) && text_[5] != '?')) return true;
  const std::size_t end = text_.find("?>");
  if (end == npos) return fail_cut("the XML declaration", 0);
  pos_ = 5;
  static constexpr std::string_view order[] = {"version", "encoding", "standalone"};
  std::size_t expected = 0;
  while (true) {
    const bool spaced = skip_space();
    if (pos_ == end) break;
    const std::size_t length = name_length(text_, pos_);
    const std::string_view key = text_.substr(pos_, length);
    const auto found = std::find(std::begin(order) + expected, std::end(order), key);
    if (!spaced || found == std::end(order) || (expected == 0 && key != "version"))
      return fail(Code::xml_declaration, pos_, std::max<std::size_t>(length, 1));
    pos_ += length;
    skip_space();
    if (!at("=")) return fail(Code::xml_declaration, pos_, 1);
    ++pos_;
    skip_space();
    const char quote = text_[pos_];
    const std::size_t close = quote == '"' || quote == '\'' ? text_.find(quote, pos_ + 1) : npos;
    if (close == npos || close > end) return fail(Code::xml_declaration, pos_, 1);
    std::string value(text_.substr(pos_ + 1, close - pos_ - 1));
    std::transform(value.begin(), value.end(), value.begin(),
                   [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
    const bool known_encoding = value == "UTF-8" || value == "UTF-16" || value == "US-ASCII";
    if (key == "encoding" && !known_encoding)
      return fail(Code::xml_encoding, pos_ + 1, value.size(), {std::string(text_.substr(pos_ + 1, value.size()))});
    if ((key == "version" && value != "1.0") || (key == "standalone" && value != "YES" && value != "NO"))
      return fail(Code::xml_declaration, pos_ + 1, value.size());
    pos_ = close + 1;
    expected = static_cast<std::size_t>(found - std::begin(order)) + 1;
  }
  if (expected == 0) return fail(Code::xml_declaration, 0, end + 2);
  pos_ = end + 2;
  return true;
}

bool Scanner::markup() {
  if (at("<!--")) return comment();
  if (at("<?")) return instruction();
  if (at("</")) return end_tag();
  if (at("<![CDATA[")) return cdata();
  if (at("<!DOCTYPE")) return fail(Code::xml_doctype, pos_, 9);
  if (cut("<!--") || cut("<![CDATA[") || cut("<!DOCTYPE") || cut("</")) return fail_cut("a tag", pos_);
  if (at("<!")) {
    pos_ += 2;
    return fail_syntax("'--' or '[CDATA['");
  }
  return start_tag();
}

bool Scanner::comment() {
  const std::size_t first = pos_;
  const std::size_t end = text_.find("--", pos_ + 4);
  if (end == npos || end + 2 >= text_.size()) return fail_cut("a comment", first);
  if (text_[end + 2] != '>') return fail(Code::xml_comment, end, 2);
  pos_ = end + 3;
  return true;
}

bool Scanner::instruction() {
  const std::size_t first = pos_;
  const std::size_t end = text_.find("?>", pos_ + 2);
  if (end == npos) return fail_cut("a processing instruction", first);
  const std::size_t length = name_length(text_, pos_ + 2);
  const std::string_view target = text_.substr(pos_ + 2, length);
  std::string lower(target.substr(0, 4));
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c | 0x20) : c; });
  const std::size_t behind = pos_ + 2 + length;
  const bool separated = behind == end || is_space(text_[behind]);
  if (length == 0 || lower == "xml" || !separated || target.find(':') != npos)
    return fail(Code::xml_instruction, first, end + 2 - first, {std::string(target)});
  pos_ = end + 2;
  return true;
}

bool Scanner::cdata() {
  const std::size_t first = pos_;
  const std::size_t end = text_.find("]]>", pos_ + 9);
  if (open_.empty()) return fail(Code::xml_text_outside_root, pos_, 9, {"<![CDATA["});
  if (end == npos) return fail_cut("a CDATA section", first);
  note_text(pos_ + 9, end);
  pos_ = end + 3;
  return true;
}

bool Scanner::characters() {
  const std::size_t first = pos_;
  const std::size_t end = std::min(text_.find('<', pos_), text_.size());
  if (open_.empty()) {
    skip_space();
    if (pos_ >= end) return true;
    const std::string found(text_.substr(pos_, decode_utf8(text_, pos_).length));
    return fail(out_.elements.empty() ? Code::xml_not_xml : Code::xml_text_outside_root, pos_, found.size(), {found});
  }
  const std::size_t forbidden = text_.substr(first, end - first).find("]]>");
  if (forbidden != npos) return fail(Code::xml_cdata_end, first + forbidden, 3);
  if (!references(first, end)) return false;
  note_text(first, end);
  pos_ = end;
  return true;
}

void Scanner::note_text(std::size_t first, std::size_t last) {
  while (first < last && is_space(text_[first])) ++first;
  while (last > first && is_space(text_[last - 1])) --last;
  std::string_view& noted = out_.elements[open_.back()].text;
  if (first < last && noted.empty()) noted = text_.substr(first, last - first);
}

bool Scanner::references(std::size_t first, std::size_t last) {
  const std::string_view run = text_.substr(0, last);
  for (std::size_t i = run.find('&', first); i != npos; i = run.find('&', i + 1)) {
    const std::size_t name = i + 1 < last && run[i + 1] == '#' ? i + 2 : i + 1;
    std::size_t end = name;
    while (end < last && is_name_character(static_cast<unsigned char>(run[end]))) ++end;
    if (end == last && last == text_.size()) return fail_cut("a reference", i);
    if (end == last || run[end] != ';' || end == name)
      return fail(Code::xml_bad_reference, i, std::max<std::size_t>(end - i, 1), {std::string(run.substr(i, end - i))});
    if (reference_value(run.substr(i + 1, end - i - 1))) continue;
    const bool numeric = run[i + 1] == '#';
    return fail(numeric ? Code::xml_bad_reference : Code::xml_unknown_entity, i, end + 1 - i,
                {std::string(run.substr(i, end + 1 - i))});
  }
  return true;
}

bool Scanner::start_tag() {
  const std::size_t first = pos_;
  if (open_.empty() && !out_.elements.empty()) return fail(Code::xml_second_root, pos_, 1);
  if (open_.size() >= limits_.max_depth) return fail(Code::xml_too_deep, pos_, 1, {std::to_string(limits_.max_depth)});
  if (!add_node()) return false;
  const auto index = static_cast<std::uint32_t>(out_.elements.size());
  out_.elements.push_back({.offset = first, .first_attribute = static_cast<std::uint32_t>(out_.attributes.size())});
  ++pos_;
  ScannedName tag;
  if (!name(tag, "an element name behind '<' (a literal '<' is written &lt;)")) return false;
  out_.elements[index].name = tag;
  bool empty = false;
  while (true) {
    const bool spaced = skip_space();
    if (at_end() || cut("/>")) return fail_cut("the tag <" + std::string(tag.text) + ">", first);
    empty = at("/>");
    if (empty || at(">")) break;
    if (!spaced) return fail_syntax("white space, '>' or '/>'");
    if (!attribute()) return false;
  }
  pos_ += empty ? 2 : 1;
  ScannedElement& e = out_.elements[index];
  e.tag_length = pos_ - first;
  e.attribute_count = static_cast<std::uint32_t>(out_.attributes.size()) - e.first_attribute;
  open_.push_back(index);
  if (!resolve_names(index)) return false;
  if (empty) close(pos_);
  return true;
}

bool Scanner::attribute() {
  if (!add_node()) return false;
  const std::size_t first = pos_;
  ScannedAttribute a;
  if (!name(a.name, "an attribute name, '>' or '/>'")) return false;
  skip_space();
  const auto what = [&] { return "the attribute '" + std::string(a.name.text) + "'"; };
  if (at_end()) return fail_cut(what(), first);
  if (!at("=")) return fail_syntax("'=' behind " + what());
  ++pos_;
  skip_space();
  if (at_end()) return fail_cut(what(), first);
  const char quote = text_[pos_];
  if (quote != '"' && quote != '\'') return fail_syntax("a quoted value of " + what());
  ++pos_;
  const std::size_t close = text_.find(quote, pos_);
  const std::size_t end = std::min(close, text_.size());
  const std::size_t less = text_.substr(pos_, end - pos_).find('<');
  if (less != npos) return fail(Code::xml_less_than_in_attribute, pos_ + less, 1, {std::string(a.name.text)});
  if (!references(pos_, end)) return false;
  if (close == npos) return fail_cut("the value of " + what(), first);
  a.value = text_.substr(pos_, close - pos_);
  out_.attributes.push_back(a);
  pos_ = close + 1;
  return true;
}

bool Scanner::end_tag() {
  const std::size_t first = pos_;
  pos_ += 2;
  ScannedName tag;
  if (!name(tag, "the name of the element to close")) return false;
  if (!at_end() && open_.empty()) return fail(Code::xml_stray_end_tag, first, pos_ - first, {std::string(tag.text)});
  if (at_end()) return fail_cut("the tag </" + std::string(tag.text) + ">", first);
  const ScannedElement& e = out_.elements[open_.back()];
  if (e.name.text != tag.text) {
    fail(Code::xml_tag_mismatch, first, pos_ - first, {std::string(e.name.text), std::string(tag.text)});
    fault_.related_offset = e.offset;
    fault_.related_note = "<" + std::string(e.name.text) + "> opened here";
    return false;
  }
  skip_space();
  if (at_end()) return fail_cut("the tag </" + std::string(tag.text) + ">", first);
  if (!at(">")) return fail_syntax("'>'");
  close(++pos_);
  return true;
}

void Scanner::close(std::size_t end) {
  const std::uint32_t index = open_.back();
  open_.pop_back();
  out_.elements[index].end = end;
  out_.elements[index].next = static_cast<std::uint32_t>(out_.elements.size());
  scope_.leave(index);
}

bool Scanner::name(ScannedName& out, std::string_view expected) {
  const std::size_t length = name_length(text_, pos_);
  if (length == 0) return at_end() ? fail_cut("a tag", text_.rfind('<')) : fail_syntax(expected);
  out.text = text_.substr(pos_, length);
  const std::size_t colon = out.text.find(':');
  if (colon != npos) {
    const bool local_starts = colon + 1 < length && is_name_start(decode_utf8(out.text, colon + 1).character);
    if (pos_ + length < text_.size() && (colon == 0 || !local_starts || out.text.find(':', colon + 1) != npos))
      return fail(Code::xml_namespace, pos_, length, {"'" + std::string(out.text) + "' is not prefix:name"});
    out.local_offset = colon + 1;
  }
  pos_ += length;
  return true;
}

bool Scanner::resolve_names(std::uint32_t element) {
  if (!declare_namespaces(element)) return false;
  ScannedElement& e = out_.elements[element];
  if (!resolve(e.name, true)) return false;
  for (std::uint32_t i = 0; i < e.attribute_count; ++i) {
    if (!resolve(out_.attributes[e.first_attribute + i].name, false)) return false;
  }
  return distinct_attributes(e);
}

bool Scanner::declare_namespaces(std::uint32_t element) {
  const ScannedElement& e = out_.elements[element];
  for (std::uint32_t i = 0; i < e.attribute_count; ++i) {
    ScannedAttribute& a = out_.attributes[e.first_attribute + i];
    if (a.name.text != "xmlns" && !a.name.text.starts_with("xmlns:")) continue;
    a.name.space = xmlns_namespace;
    if (!declare(a, element)) return false;
  }
  return true;
}

bool Scanner::declare(const ScannedAttribute& a, std::uint32_t element) {
  const std::string_view prefix = a.name.local_offset == 0 ? std::string_view() : a.name.local();
  const std::string uri = normalized_attribute_value(a.value);
  const bool reserved_uri = uri == "http://www.w3.org/2000/xmlns/";
  const bool xml_uri = uri == "http://www.w3.org/XML/1998/namespace";
  const auto refuse = [&](const char* why) {
    return fail(Code::xml_namespace, offset_of(a.name.text), a.name.text.size(), {why});
  };
  if (prefix == "xmlns" || reserved_uri) return refuse("the prefix 'xmlns' and its namespace cannot be declared");
  if (xml_uri != (prefix == "xml")) return refuse("the prefix 'xml' and its namespace belong together");
  if (!prefix.empty() && uri.empty()) return refuse("a prefix cannot be bound to no namespace");
  scope_.declare(prefix, uri, element);
  return true;
}

bool Scanner::resolve(ScannedName& name, bool uses_default) {
  if (name.space == xmlns_namespace) return true;
  if (name.local_offset == 0 && !uses_default) return true;
  const std::string_view prefix =
      name.local_offset == 0 ? std::string_view() : name.text.substr(0, name.local_offset - 1);
  name.binding = scope_.find(prefix);
  if (name.binding == ScannedName::unbound)
    return prefix.empty() ||
           fail(Code::xml_undeclared_prefix, offset_of(name.text), prefix.size(), {std::string(prefix)});
  name.space = out_.bindings[name.binding].namespace_number;
  return true;
}

bool Scanner::distinct_attributes(const ScannedElement& e) {
  if (e.attribute_count < 2) return true;
  std::vector<const ScannedName*>& names = names_;
  names.clear();
  for (std::uint32_t i = 0; i < e.attribute_count; ++i) names.push_back(&out_.attributes[e.first_attribute + i].name);
  const auto key = [](const ScannedName* n) { return std::pair(n->space, n->local()); };
  // Equal names stay in the order of the file: their addresses are.
  std::sort(names.begin(), names.end(),
            [&](auto* a, auto* b) { return std::tuple(key(a), a) < std::tuple(key(b), b); });
  const auto same = std::adjacent_find(names.begin(), names.end(), [&](auto* a, auto* b) { return key(a) == key(b); });
  if (same == names.end()) return true;
  const std::string_view second = same[1]->text;
  fail(Code::xml_duplicate_attribute, offset_of(second), second.size(),
       {std::string(second), std::string(e.name.text)});
  fault_.related_offset = offset_of(same[0]->text);
  fault_.related_note = "first here";
  return false;
}

}  // namespace

std::variant<Scan, ScanFault> scan(std::string_view text, ScanLimits limits) { return Scanner(text, limits).run(); }

}  // namespace meso::xml
