// SPDX-License-Identifier: Apache-2.0
// Two judges: the schema says the same as the describe table, and xmllint with the schema gives the same verdict as the
// reader on every structural case.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <pugixml.hpp>
#include <set>

#include "shape.hpp"
#include "structure_cases.hpp"

namespace meso::xml {
namespace {

const std::string schema_file = std::string(MESO_SOURCE_DIR) + "/schema/meso-1.0.xsd";

/// Compares shapes and complex types, element by element, from the root.
class Comparison {
 public:
  Comparison() {
    EXPECT_TRUE(document_.load_file(schema_file.c_str()));
    schema_ = document_.document_element();
  }
  void compare_root() {
    compare("meso", shape_of<Document>(),
            schema_.find_child_by_attribute("xs:element", "name", "meso").attribute("type").value());
  }
  [[nodiscard]] std::size_t types_seen() const { return seen_.size(); }
  [[nodiscard]] std::size_t types_declared() const {
    std::size_t count = 0;
    for ([[maybe_unused]] const auto& t : schema_.children("xs:complexType")) ++count;
    return count;
  }

 private:
  struct SchemaSlot {
    bool repeated = false;
    std::vector<std::pair<std::string, std::string>> elements;  ///< name, type
    friend bool operator==(const SchemaSlot&, const SchemaSlot&) = default;
  };

  void compare(std::string_view name, const ElementShape& shape, const std::string& type_name) {
    if (!seen_.insert(&shape).second) return;
    SCOPED_TRACE("<" + std::string(name) + "> of type " + type_name);
    const pugi::xml_node type = schema_.find_child_by_attribute("xs:complexType", "name", type_name.c_str());
    ASSERT_TRUE(type);
    EXPECT_EQ(static_cast<bool>(type.child("xs:simpleContent")), shape.has_text);
    EXPECT_EQ(static_cast<bool>(type.child("xs:choice")), shape.any_order);
    compare_attributes(shape, shape.has_text ? type.child("xs:simpleContent").child("xs:extension") : type);

    const std::vector<SchemaSlot> slots = slots_of(type);
    std::vector<const Alternative*> mine;
    ASSERT_EQ(slots.size(), shape.has_text ? 0 : shape.any_order ? 1 : shape.slots.size());
    for (std::size_t i = 0; i < shape.slots.size(); ++i) {
      const Slot& slot = shape.slots[i];
      const bool once = slot.kind == SlotKind::single || slot.kind == SlotKind::choice;
      EXPECT_EQ(slots[shape.any_order ? 0 : i].repeated, !once);
      const SchemaSlot& theirs = slots[shape.any_order ? 0 : i];
      const std::size_t offset = shape.any_order ? i : 0;
      ASSERT_EQ(theirs.elements.size(), shape.any_order ? shape.slots.size() : slot.alternatives.size());
      for (std::size_t k = 0; k < slot.alternatives.size(); ++k) {
        EXPECT_EQ(theirs.elements[offset + k].first, slot.alternatives[k].name);
        compare(slot.alternatives[k].name, slot.alternatives[k].shape(), theirs.elements[offset + k].second);
      }
    }
  }

  void compare_attributes(const ElementShape& shape, const pugi::xml_node& holder) {
    auto theirs = holder.children("xs:attribute").begin();
    const auto end = holder.children("xs:attribute").end();
    for (const AttributeShape& a : shape.attributes) {
      SCOPED_TRACE("attribute " + std::string(a.name));
      ASSERT_NE(theirs, end);
      EXPECT_EQ(theirs->attribute("name").value(), a.name);
      EXPECT_EQ(theirs->attribute("use").value() == std::string("required"), a.required);
      compare_value_type(a, theirs->attribute("type").value());
      ++theirs;
    }
    EXPECT_EQ(theirs, end) << theirs->attribute("name").value();
    EXPECT_TRUE(holder.child("xs:anyAttribute"));
  }

  void compare_value_type(const AttributeShape& a, const std::string& type_name) {
    static const std::map<ValueKind, std::set<std::string>> allowed = {{ValueKind::id, {"Name"}},
                                                                       {ValueKind::reference, {"Name"}},
                                                                       {ValueKind::name, {"Name"}},
                                                                       {ValueKind::expression, {"Expression"}},
                                                                       {ValueKind::expressions, {"ExpressionList"}},
                                                                       {ValueKind::href, {"Href"}},
                                                                       {ValueKind::text, {"Text", "Sha256", "Version"}},
                                                                       {ValueKind::number, {"Number"}},
                                                                       {ValueKind::integer, {"Integer"}},
                                                                       {ValueKind::boolean, {"Boolean"}}};
    const pugi::xml_node type = schema_.find_child_by_attribute("xs:simpleType", "name", type_name.c_str());
    ASSERT_TRUE(type) << type_name;
    if (a.kind != ValueKind::choice) {
      EXPECT_TRUE(allowed.at(a.kind).contains(type_name)) << type_name;
      EXPECT_EQ(type_name == "Sha256", a.name == "sha256");
      return;
    }
    std::vector<std::string_view> choices;
    for (const auto& e : type.child("xs:restriction").children("xs:enumeration"))
      choices.emplace_back(e.attribute("value").value());
    EXPECT_EQ(choices, a.choices);
  }

  std::vector<SchemaSlot> slots_of(const pugi::xml_node& type) {
    if (type.child("xs:choice")) return {{true, elements_in(type.child("xs:choice"))}};
    std::vector<SchemaSlot> out;
    for (const auto& s : type.child("xs:sequence").children("xs:sequence"))
      out.push_back({s.attribute("maxOccurs").value() == std::string("unbounded"), elements_in(s)});
    return out;
  }
  std::vector<std::pair<std::string, std::string>> elements_in(const pugi::xml_node& particle) {
    std::vector<std::pair<std::string, std::string>> out;
    for (const auto& n : particle.children()) {
      std::vector<std::pair<std::string, std::string>> inner;
      const std::string kind = n.name();
      if (kind == "xs:element") inner = {{n.attribute("name").value(), n.attribute("type").value()}};
      if (kind == "xs:choice") inner = elements_in(n);
      if (kind == "xs:group") {
        const auto group = schema_.find_child_by_attribute("xs:group", "name", n.attribute("ref").value());
        inner = elements_in(group.first_child());
      }
      out.insert(out.end(), inner.begin(), inner.end());
    }
    return out;
  }

  pugi::xml_document document_;
  pugi::xml_node schema_;
  std::set<const ElementShape*> seen_;
};

TEST(Schema, SaysWhatTheDescribeTableSays) {
  Comparison c;
  c.compare_root();
  EXPECT_EQ(c.types_seen(), c.types_declared());
  EXPECT_GT(c.types_seen(), 70U);
}

TEST(Schema, GivesTheVerdictOfTheReader) {
  if (std::system("xmllint --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "xmllint is not installed";
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "meso_schema_cases";
  std::filesystem::create_directories(folder);
  const std::string file = (folder / "case.meso").string();
  const std::string answer_file = (folder / "answer.txt").string();
  for (const StructureCase& c : structure_cases()) {
    if (c.reach == SchemaReach::beyond) continue;
    std::string text = c.marked_text;
    std::erase(text, '^');
    std::ofstream(file, std::ios::binary) << text;
    const std::string command =
        "xmllint --noout --nonet --schema '" + schema_file + "' '" + file + "' >/dev/null 2>'" + answer_file + "'";
    const bool accepted = std::system(command.c_str()) == 0;
    std::ifstream stream(answer_file);
    const std::string answer(std::istreambuf_iterator<char>(stream), {});
    // xmllint tells faults of namespaces and goes on.
    const bool good = accepted && answer.find("namespace error") == std::string::npos;
    EXPECT_EQ(good, !c.fault) << c.name << ": " << text << "\n" << answer;
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace meso::xml
