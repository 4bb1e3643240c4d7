// SPDX-License-Identifier: Apache-2.0
#include "meso/package/referenced_files.hpp"

#include <algorithm>

#include "meso/model/walk.hpp"

namespace meso {

std::vector<ReferencedFile> referenced_files(const CheckedDocument& checked) {
  std::vector<ReferencedFile> files;
  ReferencedFile::Use* last = nullptr;  // the href of an element stands before its sum
  walk(checked.document(), [&](const Element& element, std::string_view attribute, const auto& value) {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, Href>) {
      const auto name = normalized_href(value.text);
      auto resource = checked.resources().find(value.text);
      if (!name || !resource) return;  // a checked document has none of these
      auto known = std::find_if(files.begin(), files.end(), [&](const ReferencedFile& f) { return f.name == *name; });
      if (known == files.end()) known = files.insert(known, {*name, std::move(*resource), {}});
      last = &known->uses.emplace_back(ReferencedFile::Use{element.id_in_source});
    }
    if constexpr (std::is_same_v<Value, std::string>) {
      if (attribute == "sha256" && last != nullptr && last->element.value == element.id_in_source.value)
        last->has_sha256 = true;
    }
  });
  return files;
}

}  // namespace meso
