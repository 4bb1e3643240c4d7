// SPDX-License-Identifier: Apache-2.0
#include "meso/xml/write.hpp"

#include <algorithm>
#include <cassert>

#include "characters.hpp"
#include "meso/base/xml_text.hpp"
#include "value_text.hpp"
#include "write_text.hpp"

namespace meso {
namespace xml {
namespace {

enum class Form { plain, canonical };

template <class T>
std::string attribute_text(const T& value, Form form) {
  constexpr ValueKind kind = value_kind<T>();
  if (form == Form::canonical && (kind == ValueKind::expression || kind == ValueKind::expressions))
    return collapsed(value_text(value));
  return value_text(value);
}

/// The lines of one file.
class Output {
 public:
  explicit Output(Form form) : form_(form) {}
  [[nodiscard]] Form form() const { return form_; }
  [[nodiscard]] std::string& text() { return text_; }

  void line(std::size_t depth, std::string_view content) {
    text_.append(2 * depth, ' ');
    text_ += content;
    text_ += '\n';
  }
  /// the canonical form has no comments and no processing instructions; foreign elements may carry meaning.
  [[nodiscard]] bool keeps(const Trivia& t) const { return form_ == Form::plain || t.kind == Trivia::Kind::foreign; }
  [[nodiscard]] bool keeps_any(const std::vector<Trivia>& all) const {
    return std::any_of(all.begin(), all.end(), [&](const Trivia& t) { return keeps(t); });
  }
  void trivia(std::size_t depth, const std::vector<Trivia>& all) {
    for (const Trivia& t : all)
      if (keeps(t)) line(depth, t.text);
  }
  void foreign(std::vector<ForeignAttribute> all) {
    if (form_ == Form::canonical) {
      const auto key = [](const ForeignAttribute& a) { return std::pair(!a.name.starts_with("xmlns:"), a.name); };
      std::sort(all.begin(), all.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
    }
    for (const ForeignAttribute& a : all) text_ += ' ' + a.name + "=\"" + escaped_attribute(a.value) + '"';
  }

 private:
  Form form_;
  std::string text_;
};

/// Writes one element: attributes as they come, and the start tag's end before the first child.
class WriteVisitor {
 public:
  WriteVisitor(Output& out, std::string_view name, std::size_t depth, const Element& element)
      : out_(out), name_(name), depth_(depth), element_(element) {
    out_.trivia(depth_, element_.before);
    out_.text().append(2 * depth_, ' ');
    out_.text() += '<';
    out_.text() += name_;
    if (depth_ == 0) put("xmlns", meso_namespace);
  }

  template <class T>
  void attribute(std::string_view name, const T& value) {
    put(name, attribute_text(value, out_.form()));
  }
  template <class T>
  void attribute(std::string_view name, const std::optional<T>& value) {
    if (value) attribute(name, *value);
  }
  void text(const std::string& value) {
    end_start_tag();
    out_.text() += escaped_text(value);
    has_text_ = true;
  }
  template <class T>
  void child(std::string_view name, const std::optional<T>& value) {
    if (value) element(name, *value);
  }
  template <class T>
  void children(std::string_view name, const std::vector<T>& values) {
    for (const T& value : values) element(name, value);
  }
  template <class T>
  void sequence(const std::vector<T>& values) {
    for (const T& value : values) choice(variant_of(value));
  }
  template <class... Ts>
  void choice(const std::variant<Ts...>& value) {
    std::visit(
        [this]<class T>(const T& alternative) {
          if constexpr (!std::is_same_v<T, std::monostate>) element(element_name<T>, alternative);
        },
        value);
  }
  template <class T>
  void section(std::string_view name, const Section<T>& section, std::string_view item) {
    const bool has_content = !section.items.empty() || !section.foreign.empty() || out_.keeps_any(section.inside);
    if (!has_content && !out_.keeps_any(section.before)) return;
    start_child();
    WriteVisitor inner(out_, name, depth_ + 1, section);
    inner.children(item, section.items);
    inner.finish();
  }
  void finish();

 private:
  void put(std::string_view name, std::string_view value) {
    out_.text() += ' ';
    out_.text() += name;
    out_.text() += "=\"" + escaped_attribute(value) + '"';
  }
  void end_start_tag() {
    if (open_) return;
    out_.foreign(element_.foreign);
    out_.text() += '>';
    open_ = true;
  }
  void start_child() {
    if (!open_) {
      end_start_tag();
      out_.text() += '\n';
    }
  }
  template <class E>
  void element(std::string_view name, const E& e);

  Output& out_;
  std::string_view name_;
  std::size_t depth_;
  const Element& element_;
  bool open_ = false;
  bool has_text_ = false;
};

void WriteVisitor::finish() {
  if (has_text_) {
    // Inside text, line ends and indentation would become part of it.
    for (const Trivia& t : element_.inside)
      if (out_.keeps(t)) out_.text() += t.text;
  } else if (out_.keeps_any(element_.inside)) {
    start_child();
    out_.trivia(depth_ + 1, element_.inside);
  }
  if (!open_) {
    out_.foreign(element_.foreign);
    out_.text() += "/>\n";
    return;
  }
  if (!has_text_) out_.text().append(2 * depth_, ' ');
  out_.text() += "</";
  out_.text() += name_;
  out_.text() += ">\n";
}

template <class E>
void WriteVisitor::element(std::string_view name, const E& e) {
  start_child();
  WriteVisitor inner(out_, name, depth_ + 1, e);
  if constexpr (std::is_same_v<E, EmbeddedValues>) {
    // R-4.7: line breaks in base64 mean nothing.
    EmbeddedValues bare = e;
    if (out_.form() == Form::canonical) std::erase_if(bare.base64, is_space);
    describe(inner, std::as_const(bare));
  } else {
    describe(inner, e);
  }
  inner.finish();
}

std::string write(const Document& document, Form form) {
  Output out(form);
  if (form == Form::plain) out.line(0, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>");
  WriteVisitor root(out, "meso", 0, document);
  describe(root, document);
  root.finish();
  out.trivia(0, document.after);
  assert(find_bad_character(out.text()) == std::string_view::npos);
  return std::move(out.text());
}

}  // namespace
}  // namespace xml

std::string write_document(const Document& document) { return xml::write(document, xml::Form::plain); }
std::string canonical_document(const Document& document) { return xml::write(document, xml::Form::canonical); }

}  // namespace meso
