// SPDX-License-Identifier: Apache-2.0
#include "ply_header.hpp"

#include <algorithm>
#include <array>

namespace meso {
namespace {

std::optional<PlyType> type_named(std::string_view name) {
  struct Named {
    std::string_view name;
    PlyType type;
  };
  using enum PlyType;
  static constexpr std::array<Named, 16> types{{{"char", int8},
                                                {"int8", int8},
                                                {"uchar", uint8},
                                                {"uint8", uint8},
                                                {"short", int16},
                                                {"int16", int16},
                                                {"ushort", uint16},
                                                {"uint16", uint16},
                                                {"int", int32},
                                                {"int32", int32},
                                                {"uint", uint32},
                                                {"uint32", uint32},
                                                {"float", float32},
                                                {"float32", float32},
                                                {"double", float64},
                                                {"float64", float64}}};
  const auto found = std::find_if(types.begin(), types.end(), [&](const Named& t) { return t.name == name; });
  if (found == types.end()) return {};
  return found->type;
}

class HeaderReader {
 public:
  HeaderReader(TextScanner& scanner, DiagnosticSink& sink) : scanner_(scanner), sink_(sink) {}

  std::optional<PlyHeader> read() {
    if (scanner_.word() != "ply") return fail("ply");
    bool format_known = false;
    for (std::string_view word = scanner_.word(); word != "end_header"; word = scanner_.word()) {
      bool read = true;
      if (word == "format")
        read = format_known = read_format();
      else if (word == "element")
        read = read_element();
      else if (word == "property")
        read = read_property();
      else if (word != "comment" && word != "obj_info")
        return fail("end_header");
      if (!read) return {};
      scanner_.skip_line();
    }
    if (!format_known) return fail("format");
    scanner_.skip_line();
    return std::move(header_);
  }

 private:
  std::nullopt_t fail(std::string what) {
    sink_.report(scanner_.expected(std::move(what)));
    return std::nullopt;
  }
  bool refuse(std::string what) {
    (void)fail(std::move(what));
    return false;
  }

  bool read_format() {
    const std::string_view word = scanner_.word_on_line();
    if (word == "ascii")
      header_.format = PlyFormat::ascii;
    else if (word == "binary_little_endian")
      header_.format = PlyFormat::little_endian;
    else if (word == "binary_big_endian")
      header_.format = PlyFormat::big_endian;
    else
      return refuse("ascii, binary_little_endian or binary_big_endian");
    return scanner_.word_on_line() == "1.0" || refuse("1.0");
  }

  bool read_element() {
    PlyElement element{.name = std::string(scanner_.word_on_line())};
    const std::optional<std::int64_t> count = to_integer(scanner_.word_on_line());
    if (!count || *count < 0) return refuse("the number of elements");
    element.count = static_cast<std::uint64_t>(*count);
    header_.elements.push_back(std::move(element));
    return true;
  }

  bool read_property() {
    if (header_.elements.empty()) return refuse("element");
    PlyProperty property;
    std::string_view word = scanner_.word_on_line();
    if (word == "list") {
      property.count_type = type_named(scanner_.word_on_line());
      if (!property.count_type || !is_whole(*property.count_type)) return refuse("a type of whole numbers");
      word = scanner_.word_on_line();
    }
    const std::optional<PlyType> type = type_named(word);
    if (!type) return refuse("a type");
    property.type = *type;
    property.name = scanner_.word_on_line();
    if (property.name.empty()) return refuse("the name of a property");
    header_.elements.back().properties.push_back(std::move(property));
    return true;
  }

  TextScanner& scanner_;
  DiagnosticSink& sink_;
  PlyHeader header_;
};

}  // namespace

std::uint64_t PlyElement::least_bytes(PlyFormat format) const {
  std::uint64_t sum = 0;
  for (const PlyProperty& p : properties)
    sum += format == PlyFormat::ascii ? 2 : bytes_of(p.count_type.value_or(p.type));  // a digit and a blank
  return sum;
}

bool PlyElement::has_lists() const {
  return std::any_of(properties.begin(), properties.end(), [](const PlyProperty& p) { return p.count_type; });
}

std::optional<std::size_t> PlyElement::find(std::string_view property) const {
  const auto found =
      std::find_if(properties.begin(), properties.end(), [&](const PlyProperty& p) { return p.name == property; });
  if (found == properties.end()) return {};
  return static_cast<std::size_t>(found - properties.begin());
}

std::optional<PlyHeader> read_ply_header(TextScanner& scanner, DiagnosticSink& sink) {
  return HeaderReader(scanner, sink).read();
}

}  // namespace meso
