// SPDX-License-Identifier: Apache-2.0
#include "meso/model/source_map.hpp"

#include <gtest/gtest.h>

#include "meso/model/describe.hpp"

namespace meso {
namespace {

// Counts what describe() visits, to show that every kind of field reaches a visitor.
struct CountingVisitor {
  int attributes = 0, texts = 0, children_seen = 0;
  template <class T>
  void attribute(std::string_view, T&) {
    ++attributes;
  }
  void text(const std::string&) { ++texts; }
  template <class T>
  void child(std::string_view, T&) {
    ++children_seen;
  }
  template <class T>
  void children(std::string_view, std::vector<T>& all) {
    for (T& e : all) {
      ++children_seen;
      describe(*this, e);
    }
  }
  template <class T>
  void sequence(std::vector<T>&) {}
  template <class T>
  void choice(T&) {}
  template <class T>
  void section(std::string_view, Section<T>& s, std::string_view item) {
    children(item, s.items);
  }
};

TEST(Describe, VisitsSectionsAndTheirItems) {
  Document d;
  d.parameters.items.resize(2);
  d.patterns.items.resize(1);
  CountingVisitor v;
  describe(v, d);
  EXPECT_EQ(v.attributes, 3 + 2 * 5 + 4);
}

TEST(SourceMap, CountsColumnsInCodePoints) {
  const SourceMap map("f", "ab\n\xC3\xA4x");  // second line: a-umlaut, x
  EXPECT_EQ(map.span_at(5, 1).line, 2U);
  EXPECT_EQ(map.span_at(5, 1).column, 2U);
}

TEST(SourceMap, MapsOffsetsThroughReferences) {
  const std::string text = "<a b=\"1 &lt; &#x263A;z\"/>";
  SourceMap map("f", text);
  const ElementId id = map.add({.path = "/a", .offset = 0, .length = text.size(), .attributes = {{"b", 3, 6, 16}}});
  // expanded value: 1 < (smiley, 3 bytes) z
  EXPECT_EQ(map.span(id, "b", 2, 1).offset, text.find("&lt;"));
  EXPECT_EQ(map.span(id, "b", 2, 1).length, 4U);
  EXPECT_EQ(map.span(id, "b", 7, 1).offset, text.find('z'));
  EXPECT_EQ(map.path(id, "b"), "/a/@b");
}

TEST(Document, EqualityIgnoresSourceIds) {
  Document a, b;
  a.parameters.items.push_back({.id = {"p"}, .value = {"1"}});
  b = a;
  b.parameters.items[0].id_in_source = {7};
  EXPECT_EQ(a, b);
  b.parameters.items[0].value.text = "2";
  EXPECT_NE(a, b);
}

}  // namespace
}  // namespace meso
