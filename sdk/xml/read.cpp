// SPDX-License-Identifier: Apache-2.0
#include "meso/xml/read.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <system_error>
#include <utility>

#include "characters.hpp"
#include "element_reader.hpp"
#include "write_text.hpp"

namespace meso {
namespace xml {

void merge_section(ElementScope& scope, Element& section, std::vector<Child>& items, std::vector<Trivia> before) {
  if (section.id_in_source.value == 0) return read_base(scope, std::move(before), section);
  // What stood at the end of the earlier element, and what stands before this one, now stands between the items.
  std::vector<Trivia> between = std::move(section.inside);
  std::move(before.begin(), before.end(), std::back_inserter(between));
  section.inside = std::move(scope.trailing());
  std::vector<Trivia>& place = items.empty() ? section.inside : items.front().before;
  std::move(place.begin(), place.end(), std::back_inserter(between));
  place = std::move(between);
  for (ForeignAttribute& f : scope.reading().foreign_attributes(scope.node())) {
    const auto same = std::find_if(section.foreign.begin(), section.foreign.end(),
                                   [&](const ForeignAttribute& s) { return s.name == f.name; });
    if (same == section.foreign.end())
      section.foreign.push_back(std::move(f));
    else if (same->value != f.value)
      scope.reading().report_tag(Code::section_attribute_differs, scope.path(), scope.node(),
                                 {f.name, std::string(scope.reading().element(scope.node()).name.local())});
  }
}

namespace {

/// UTF-8 without byte order mark, or nothing after a diagnostic.
std::optional<std::string> to_utf8(std::string bytes, const std::string& file, DiagnosticSink& sink) {
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.erase(0, 3);
  const bool big = bytes.starts_with("\xFE\xFF");
  if (big || bytes.starts_with("\xFF\xFE")) {
    auto text = utf8_from_utf16(std::string_view(bytes).substr(2), big);
    if (!text) {
      sink.report({.code = Code::xml_invalid_utf16, .where = {.file = file}});
      return std::nullopt;
    }
    bytes = std::move(*text);
  }
  if (!bytes.empty()) return bytes;
  sink.report({.code = Code::xml_empty, .where = {.file = file}});
  return std::nullopt;
}

void report_bad_character(const SourceMap& source, std::size_t at, DiagnosticSink& sink) {
  const Decoded d = decode_utf8(source.text(), at);
  char digits[16];
  const bool decoded = d.length > 0;
  std::snprintf(digits, sizeof digits, decoded ? "%04X" : "%02X",
                decoded ? static_cast<unsigned>(d.character) : static_cast<unsigned char>(source.text()[at]));
  sink.report({.code = decoded ? Code::xml_invalid_character : Code::xml_invalid_utf8,
               .where = source.span_at(at, std::max(1U, d.length)),
               .args = {digits}});
}

void report_fault(const SourceMap& source, ScanFault fault, DiagnosticSink& sink) {
  for (std::string& a : fault.args) a = shortened(a);
  Diagnostic d{.code = fault.code, .where = source.span_at(fault.offset, fault.length), .args = std::move(fault.args)};
  if (fault.related_offset) d.related.push_back({source.span_at(*fault.related_offset, 1), fault.related_note});
  sink.report(std::move(d));
}

std::vector<std::string> words(std::string_view text) {
  std::vector<std::string> out;
  std::string word;
  for (const char c : collapsed(text) + " ") {
    if (c != ' ') {
      word += c;
    } else if (!word.empty()) {
      out.push_back(std::exchange(word, {}));
    }
  }
  return out;
}

/// Is this a document that this reader may read at all? What follows would otherwise be misread, so nothing more is
/// said.
bool check_root(Reading& reading, const Node& root, const ReadOptions& options) {
  const ScannedElement& e = reading.element(root);
  const std::string name(e.name.local());
  if (e.name.space != format_namespace) {
    const std::string found = e.name.space == no_namespace
                                  ? "no namespace"
                                  : "the namespace '" + reading.scan().bindings[e.name.binding].uri + "'";
    reading.report_tag(Code::root_namespace, "/" + name, root, {found, std::string(meso_namespace)});
    return false;
  }
  if (name != "meso") {
    reading.report_tag(Code::root_name, "/" + name, root, {name});
    return false;
  }
  for (std::uint32_t i = 0; i < e.attribute_count; ++i) {
    const ScannedAttribute& a = reading.attribute(root, i);
    if (a.name.text != "requires") continue;
    std::string unknown;
    for (const std::string& w : words(normalized_attribute_value(a.value))) {
      const bool understood =
          std::find(options.understood.begin(), options.understood.end(), w) != options.understood.end();
      if (!understood) unknown += (unknown.empty() ? "'" : ", '") + w + "'";
    }
    if (unknown.empty()) continue;
    reading.report(Code::requires_unknown, "/meso/@requires", a.value, {unknown});
    return false;
  }
  for (std::uint32_t i = 0; i < e.attribute_count; ++i) {
    const ScannedAttribute& a = reading.attribute(root, i);
    if (a.name.text != "version" || a.value == "1.0") continue;
    reading.report(Code::version_unknown, "/meso/@version", a.value, {std::string(a.value)});
    return false;
  }
  return true;
}

/// The root, and the comments around it.
void read_root(Reading& reading, const pugi::xml_document& tree, Document& document) {
  Child root{{tree.document_element(), 0}, 0, 0, {}};
  std::vector<Trivia>* place = &root.before;
  for (const pugi::xml_node& node : tree.children()) {
    if (node.type() == pugi::node_element) place = &document.after;
    if (auto trivia = trivia_of(node)) place->push_back(std::move(*trivia));
  }
  read_element(reading, root, "/meso", document);
}

/// Diagnostics in the order of the file, as a reader of the file expects them.
void forward_sorted(const DiagnosticSink& collected, DiagnosticSink& sink) {
  std::vector<Diagnostic> all = collected.diagnostics();
  std::stable_sort(all.begin(), all.end(),
                   [](const Diagnostic& a, const Diagnostic& b) { return a.where.offset < b.where.offset; });
  for (Diagnostic& d : all) sink.report(std::move(d));
}

}  // namespace
}  // namespace xml

std::optional<ReadResult> read_document(std::string bytes, std::string file, DiagnosticSink& sink,
                                        const ReadOptions& options) {
  using namespace xml;
  if (bytes.size() > options.max_bytes) {
    sink.report({.code = Code::file_too_large,
                 .where = {.file = file},
                 .args = {file, std::to_string(bytes.size()), std::to_string(options.max_bytes)}});
    return std::nullopt;
  }
  auto text = to_utf8(std::move(bytes), file, sink);
  if (!text) return std::nullopt;
  ReadResult result{{}, SourceMap(std::move(file), std::move(*text))};
  SourceMap& source = result.source;

  const std::size_t bad = find_bad_character(source.text());
  if (bad != std::string_view::npos) {
    report_bad_character(source, bad, sink);
    return std::nullopt;
  }
  auto scanned = scan(source.text(), {std::min(options.max_depth, ReadOptions::deepest), options.max_nodes});
  if (auto* fault = std::get_if<ScanFault>(&scanned)) {
    report_fault(source, std::move(*fault), sink);
    return std::nullopt;
  }

  pugi::xml_document tree;
  constexpr unsigned flags = pugi::parse_cdata | pugi::parse_escapes | pugi::parse_wconv_attribute | pugi::parse_eol |
                             pugi::parse_comments | pugi::parse_pi | pugi::parse_ws_pcdata;
  const auto parsed = tree.load_buffer(source.text().data(), source.text().size(), flags, pugi::encoding_utf8);
  if (!parsed) {
    sink.report({.code = Code::internal,
                 .where = source.span_at(static_cast<std::size_t>(std::max<std::ptrdiff_t>(parsed.offset, 0)), 0),
                 .args = {std::string("two XML parsers disagree: ") + parsed.description()}});
    return std::nullopt;
  }

  DiagnosticSink collected(sink.max_diagnostics() + 1);
  Reading reading(std::get<Scan>(scanned), source, collected);
  if (check_root(reading, {tree.document_element(), 0}, options)) read_root(reading, tree, result.document);
  forward_sorted(collected, sink);
  if (collected.has_errors()) return std::nullopt;
  return result;
}

std::optional<ReadResult> read_document_file(const std::filesystem::path& file, DiagnosticSink& sink,
                                             const ReadOptions& options) {
  const auto refuse = [&](const std::string& why) {
    sink.report({.code = Code::file_not_found, .where = {.file = file.string()}, .args = {file.string(), why}});
    return std::nullopt;
  };
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) return refuse("no such file");
  if (std::filesystem::is_directory(status)) return refuse("it is a folder");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return refuse("it cannot be opened");
  // One byte more than allowed shows that a file, or an endless device, is too large.
  std::string bytes;
  char block[1 << 16];
  while (stream && bytes.size() <= options.max_bytes) {
    stream.read(block, sizeof block);
    bytes.append(block, static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad()) return refuse("reading failed");
  return read_document(std::move(bytes), file.string(), sink, options);
}

}  // namespace meso
