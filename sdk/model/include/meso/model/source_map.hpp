// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where every element and attribute of a read document stands in its text; kept beside the Document, so that parts stay
// plain values.

#include <string>
#include <string_view>
#include <vector>

#include "meso/base/source_span.hpp"
#include "meso/model/element.hpp"

namespace meso {

class SourceMap {
 public:
  struct AttributePlace {
    std::string name;
    std::size_t name_offset = 0;   ///< byte offset of the attribute's name
    std::size_t value_offset = 0;  ///< first byte inside the quotes
    std::size_t value_length = 0;  ///< raw bytes, references not expanded
  };
  struct ElementPlace {
    std::string path;        ///< /meso/patterns/pattern[2]
    std::size_t offset = 0;  ///< of the element's '<'
    std::size_t length = 0;  ///< of the start tag
    std::vector<AttributePlace> attributes;
  };

  SourceMap() = default;
  /// `text` is the whole file as UTF-8; its bytes are kept.
  SourceMap(std::string file, std::string text);

  ElementId add(ElementPlace place);
  [[nodiscard]] bool knows(ElementId id) const { return id.value > 0 && id.value <= places_.size(); }
  [[nodiscard]] const ElementPlace& at(ElementId id) const { return places_[id.value - 1]; }

  /// Path of the element, or `/@name` behind it; empty if unknown.
  [[nodiscard]] std::string path(ElementId id, std::string_view attribute = {}) const;
  /// Start tag of the element; unknown ids give a span without a line.
  [[nodiscard]] SourceSpan span(ElementId id) const;
  /// Value of an attribute; the element if it has no such attribute. `offset` and `length` count bytes of the
  /// *expanded* value and are mapped back through references such as &lt; so that the caret stands on the right byte.
  /// length 0 = to the value's end.
  [[nodiscard]] SourceSpan span(ElementId id, std::string_view attribute, std::size_t offset = 0,
                                std::size_t length = 0) const;
  /// Any place of the file.
  [[nodiscard]] SourceSpan span_at(std::size_t offset, std::size_t length) const;

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string file_;
  std::string text_;
  std::vector<std::size_t> line_starts_;
  std::vector<ElementPlace> places_;
};

}  // namespace meso
