// SPDX-License-Identifier: Apache-2.0
#pragma once
// The well-formedness pass: XML 1.0 without DTD, with namespaces. Answers where every element and attribute stands and
// which namespace it is in, or the first fault. One pass, no recursion, linear in the text.
//
// pugixml builds the tree but checks none of this (docs/decisions/0001-xml-reading.md).

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "meso/base/diagnostic.hpp"

namespace meso::xml {

/// Namespaces are numbered in order of appearance behind these.
enum NamespaceNumber : std::uint32_t { no_namespace, xml_namespace, xmlns_namespace, format_namespace };

/// A declaration in force: xmlns="..." or xmlns:prefix="...". `element` declared it.
struct Binding {
  static constexpr std::uint32_t no_element = 0xFFFFFFFF;
  std::string_view prefix;
  std::string uri;
  std::uint32_t namespace_number = no_namespace;
  std::uint32_t element = no_element;
};

struct ScannedName {
  static constexpr std::uint32_t unbound = 0xFFFFFFFF;
  std::string_view text;               ///< as written
  std::size_t local_offset = 0;        ///< of the part behind the colon
  std::uint32_t binding = unbound;     ///< into Scan::bindings
  std::uint32_t space = no_namespace;  ///< namespace number
  [[nodiscard]] std::string_view local() const { return text.substr(local_offset); }
};

struct ScannedAttribute {
  ScannedName name;
  std::string_view value;  ///< raw bytes between the quotes
};

struct ScannedElement {
  ScannedName name;
  std::size_t offset = 0;      ///< of '<'
  std::size_t tag_length = 0;  ///< of the start tag
  std::size_t end = 0;         ///< behind the end tag
  std::uint32_t next = 0;      ///< first element that is not inside this one
  std::uint32_t first_attribute = 0, attribute_count = 0;
  std::string_view text;  ///< first own text that is not white space
};

/// Elements in document order. Views point into the scanned text.
struct Scan {
  std::vector<ScannedElement> elements;
  std::vector<ScannedAttribute> attributes;
  std::vector<Binding> bindings;
};

struct ScanFault {
  Code code{};
  std::size_t offset = 0, length = 0;
  std::vector<std::string> args;
  std::optional<std::size_t> related_offset;  ///< "opened here", "first here"
  std::string related_note;
};

struct ScanLimits {
  std::size_t max_depth;
  std::size_t max_nodes;  ///< elements and attributes
};

/// `text` is UTF-8 of XML characters only (find_bad_character), without byte order mark.
[[nodiscard]] std::variant<Scan, ScanFault> scan(std::string_view text, ScanLimits limits);

}  // namespace meso::xml
