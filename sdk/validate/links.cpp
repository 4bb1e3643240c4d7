// SPDX-License-Identifier: Apache-2.0
// Ids, the references to them, and files.
#include <algorithm>

#include "families.hpp"
#include "meso/model/walk.hpp"

namespace meso {
namespace {

template <class T>
void collect(Context& c) {
  std::size_t index = 0;
  for (const T& item : KindOf<T>::items(c.document)) {
    const std::string& id = item.id.text;
    const auto [entry, is_new] = c.ids.try_emplace(id, Context::Entry{KindOf<T>::kind, index, &item});
    if (!is_new)
      c.report_with_related(Code::id_duplicate, item, "id", {id, std::string(to_text(entry->second.kind))},
                            *entry->second.element, "id", "the other one");
    else
      (void)c.check_name(item, "id", id);
    ++index;
  }
}

bool is_sha256(std::string_view text) {
  return text.size() == 64 &&
         std::all_of(text.begin(), text.end(), [](char d) { return (d >= '0' && d <= '9') || (d >= 'a' && d <= 'f'); });
}

class LinkCheck {
 public:
  explicit LinkCheck(Context& c) : c_(c) {}

  template <class T>
  void operator()(const Element&, std::string_view, const T&) {}

  template <class T>
  void operator()(const Element& element, std::string_view attribute, const Ref<T>& ref) {
    const std::string needed(to_text(KindOf<T>::kind));
    const auto found = c_.ids.find(ref.text);
    if (found == c_.ids.end()) {
      c_.report(Code::link_unknown_id, element, attribute, {needed, ref.text, nearest_of<T>(ref.text)});
    } else if (found->second.kind != KindOf<T>::kind) {
      const Context::Entry& entry = found->second;
      c_.report_with_related(Code::link_wrong_kind, element, attribute,
                             {ref.text, std::string(to_text(entry.kind)), needed}, *entry.element, "id",
                             "declared here");
    }
  }

  void operator()(const Element& element, std::string_view attribute, const Href& href) {
    const auto file = c_.resources.find(href.text);
    if (!file)
      c_.report(Code::href_outside, element, attribute, {href.text});
    else if (!file->exists())
      c_.report(Code::href_not_found, element, attribute, {href.text});
  }

  void operator()(const Element& element, std::string_view attribute, const std::string& text) {
    if (attribute == "sha256" && !is_sha256(text)) c_.report(Code::value_sha256, element, attribute, {text});
  }

 private:
  template <class T>
  std::string nearest_of(std::string_view word) const {
    if (c_.is_full()) return {};
    std::vector<std::string_view> candidates;
    for (const T& item : KindOf<T>::items(c_.document)) candidates.push_back(item.id.text);
    return c_.suggestion(word, candidates);
  }

  Context& c_;
};

}  // namespace

void collect_ids(Context& c) {
  collect<Parameter>(c);
  collect<CoordinateSystem>(c);
  collect<Macrostructure>(c);
  collect<UnitCell>(c);
  collect<VectorField>(c);
  collect<Pattern>(c);
  collect<Part>(c);
}

void check_links(Context& c) { walk(c.document, LinkCheck(c)); }

}  // namespace meso
