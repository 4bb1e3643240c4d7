// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "meso/model/describe.hpp"
#include "meso/operations/compare.hpp"
#include "meso/resource/resource.hpp"

namespace meso::operations {
namespace {

/// Visits every href of a document, in document order.
class HrefCollector {
 public:
  explicit HrefCollector(std::vector<std::string>& hrefs) : hrefs_(hrefs) {}

  template <class T>
  void attribute(std::string_view, const T& value) {
    if constexpr (std::is_same_v<T, Href>) hrefs_.push_back(value.text);
  }
  void text(const std::string&) {}
  template <class T>
  void child(std::string_view, const T& element) {
    describe(*this, element);
  }
  template <class T>
  void child(std::string_view, const std::optional<T>& element) {
    if (element) describe(*this, *element);
  }
  template <class T>
  void children(std::string_view, const std::vector<T>& elements) {
    for (const T& e : elements) describe(*this, e);
  }
  template <class T>
  void sequence(const std::vector<T>& elements) {
    for (const T& e : elements) choice(alternatives(e));
  }
  template <class... T>
  void choice(const std::variant<T...>& value) {
    std::visit(
        [this](const auto& v) {
          if constexpr (!std::is_same_v<std::decay_t<decltype(v)>, std::monostate>) describe(*this, v);
        },
        value);
  }
  template <class T>
  void section(std::string_view, const Section<T>& section, std::string_view item) {
    children(item, section.items);
  }

 private:
  static const auto& alternatives(const CsgNode& node) { return node.value; }
  static const Instruction& alternatives(const Instruction& instruction) { return instruction; }
  std::vector<std::string>& hrefs_;
};

}  // namespace

std::vector<std::filesystem::path> referenced_files(const CheckedDocument& checked) {
  std::vector<std::string> hrefs;
  HrefCollector collector(hrefs);
  describe(collector, checked.document());
  std::vector<std::filesystem::path> files;
  for (const std::string& href : hrefs) {
    const auto file = resolve_href(checked.folder(), href);
    if (file && std::find(files.begin(), files.end(), *file) == files.end()) files.push_back(*file);
  }
  return files;
}

}  // namespace meso::operations
