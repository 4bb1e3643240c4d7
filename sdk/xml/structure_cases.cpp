// SPDX-License-Identifier: Apache-2.0
#include "structure_cases.hpp"

namespace meso::xml {

std::string in_meso(const std::string& body) {
  return R"(<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter">)" + body + "</meso>";
}
std::string in_cell(const std::string& content) {
  return in_meso("<unitCells><unitCell id=\"c\">" + content + "</unitCell></unitCells>");
}

namespace {

std::vector<StructureCase> well_formedness_cases() {
  const auto in = in_meso;
  const SchemaReach beyond = SchemaReach::beyond;
  return {
      {"empty file", "^", Code::xml_empty},
      {"only white space", " \n^", Code::xml_no_root},
      {"only a comment", "<!-- a -->^", Code::xml_no_root},
      {"another format", "^ISO-10303-21;\nHEADER;", Code::xml_not_xml},
      {"text behind the root", in("") + "\n^x", Code::xml_text_outside_root},
      {"second root", in("") + "^<a/>", Code::xml_second_root},
      {"cut in a tag", "<meso^", Code::xml_truncated},
      {"cut in an element", "<meso xmlns=\"urn:meso-format:1.0\">^", Code::xml_truncated},
      {"cut in a comment", "<meso><!-- ^", Code::xml_truncated},
      {"cut in a value", "<meso a=\"1^", Code::xml_truncated},
      {"mismatched tag", in("<parts>^</part>"), Code::xml_tag_mismatch},
      {"stray end tag", "^</meso>", Code::xml_stray_end_tag},
      {"attribute twice", in("<parts q=\"1\" ^q=\"2\"/>"), Code::xml_duplicate_attribute},
      {"attribute twice by namespace", in("<parts xmlns:a=\"u\" xmlns:b=\"u\" a:q=\"1\" ^b:q=\"2\"/>"),
       Code::xml_duplicate_attribute},
      {"no space between attributes", in("<parts a=\"1\"^b=\"2\"/>"), Code::xml_syntax},
      {"no quotes", in("<parts a=^1/>"), Code::xml_syntax},
      {"no equals sign", in("<parts a^/>"), Code::xml_syntax},
      {"number as a name", in("<^1/>"), Code::xml_syntax},
      {"less than in a value", in("<parts a=\"i ^< 3\"/>"), Code::xml_less_than_in_attribute},
      {"unknown entity", in("<metadata name=\"a\">^&nbsp;</metadata>"), Code::xml_unknown_entity},
      {"bare ampersand", in("<metadata name=\"a\">a ^& b</metadata>"), Code::xml_bad_reference},
      {"reference to NUL", in("<metadata name=\"a\">^&#0;</metadata>"), Code::xml_bad_reference},
      {"reference to a surrogate", in("<metadata name=\"^&#xD800;\"/>"), Code::xml_bad_reference},
      {"DOCTYPE", "^<!DOCTYPE meso>" + in(""), Code::xml_doctype, beyond},
      {"two hyphens in a comment", in("<!-- a ^-- b -->"), Code::xml_comment},
      {"CDATA end in text", in("<metadata name=\"a\">^]]></metadata>"), Code::xml_cdata_end},
      {"late XML declaration", " ^<?xml version=\"1.0\"?>" + in(""), Code::xml_instruction},
      {"XML 1.1", "<?xml version=\"^1.1\"?>" + in(""), Code::xml_declaration, beyond},
      {"other encoding", "<?xml version=\"1.0\" encoding=\"^latin1\"?>" + in(""), Code::xml_encoding, beyond},
      {"undeclared prefix", in("<^q:a/>"), Code::xml_undeclared_prefix},
      {"prefix without namespace", in("<parts ^xmlns:q=\"\"/>"), Code::xml_namespace},
      {"two colons", in("<^q:a:b xmlns:q=\"u\"/>"), Code::xml_namespace},
      {"overlong UTF-8", in("<!-- ^\xC0\xAF -->"), Code::xml_invalid_utf8},
      {"surrogate in UTF-8", in("<!-- ^\xED\xA0\x80 -->"), Code::xml_invalid_utf8},
      {"control character", in("<!-- ^\x01 -->"), Code::xml_invalid_character},
      {"not a character", in("<!-- ^\xEF\xBF\xBF -->"), Code::xml_invalid_character},
  };
}

std::vector<StructureCase> schema_cases() {
  const auto in = in_meso;
  const SchemaReach beyond = SchemaReach::beyond;
  const std::string meso = "<meso xmlns=\"urn:meso-format:1.0\" ";
  return {
      {"wrong namespace", "^<meso xmlns=\"urn:other\" version=\"1.0\" unit=\"millimeter\"/>", Code::root_namespace},
      {"no namespace", "^<meso version=\"1.0\" unit=\"millimeter\"/>", Code::root_namespace},
      {"wrong root", "^<mesh xmlns=\"urn:meso-format:1.0\"/>", Code::root_name},
      {"unknown requirement", meso + "version=\"9\" unit=\"mm\" requires=\"^magic\"><odd/></meso>",
       Code::requires_unknown},
      {"unknown requirement alone", meso + "version=\"1.0\" unit=\"millimeter\" requires=\"^magic\"/>",
       Code::requires_unknown, beyond},
      {"unknown version", meso + "version=\"^1.1\" unit=\"millimeter\"/>", Code::version_unknown},
      {"no unit", "^" + meso + "version=\"1.0\"/>", Code::attribute_missing},
      {"unknown unit", meso + "version=\"1.0\" unit=\"^mm\"/>", Code::value_choice},
      {"unknown element", in("^<pattern/>"), Code::element_unknown},
      {"unknown element in a section", in("<patterns>^<loop/></patterns>"), Code::element_unknown},
      {"element in no namespace", in("^<parts xmlns=\"\"/>"), Code::element_no_namespace},
      {"unknown attribute", in("<parts ^ids=\"a\"/>"), Code::attribute_unknown},
      {"attribute of the format's namespace", in("<parts xmlns:m=\"urn:meso-format:1.0\" ^m:id=\"a\"/>"),
       Code::attribute_unknown},
      {"missing id", in("<parts>^<part/></parts>"), Code::attribute_missing},
      {"bad id", in("<parts><part id=\"^1a\"/></parts>"), Code::value_name},
      {"empty id", in("<parts><part id=\"^\"/></parts>"), Code::value_name},
      {"space around an id", in("<parts><part id=\"^ a\"/></parts>"), Code::value_name},
      {"children out of order", in_cell("<csg/>^<box dx=\"1\" dy=\"1\" dz=\"1\"/>"), Code::element_order},
      {"loop behind an instruction",
       in("<patterns><pattern id=\"a\" unitCell=\"c\"><when test=\"1\"/>^<loop index=\"i\" count=\"1\"/></pattern>"
          "</patterns>"),
       Code::element_order},
      {"two boxes", in_cell("<box dx=\"1\" dy=\"1\" dz=\"1\"/>^<box dx=\"1\" dy=\"1\" dz=\"1\"/>"),
       Code::element_repeated},
      {"two bodies", in_cell("<csg/>^<part ref=\"p\"/>"), Code::element_choice},
      {"unknown enumerator", in_cell("<beams cap=\"^flat\"/>"), Code::value_choice},
      {"bad boolean", in("<unitCells><unitCell id=\"c\" clipToBox=\"^1\"/></unitCells>"), Code::value_boolean},
      {"text where none may be", in("<parts> ^here </parts>"), Code::text_unexpected},
      {"CDATA where none may be", in("<parts><![CDATA[^x]]></parts>"), Code::text_unexpected},
      {"element in text", in("<metadata name=\"a\">b ^<c/></metadata>"), Code::element_unknown},
      {"foreign element in text", in("<metadata name=\"a\">b ^<c xmlns=\"u\"/></metadata>"), Code::foreign_in_text},
      {"not a number", in("<parts><part id=\"p\"><validation><volume value=\"^NaN\"/></validation></part></parts>"),
       Code::value_number},
      {"decimal comma", in("<parts><part id=\"p\"><validation><volume value=\"^1,5\"/></validation></part></parts>"),
       Code::value_number},
      {"space at a number", in("<parts><part id=\"p\"><validation><volume value=\"^1 \"/></validation></part></parts>"),
       Code::value_number},
      {"number too large",
       in("<parts><part id=\"p\"><validation><volume value=\"^1e999\"/></validation></part></parts>"),
       Code::value_number_range, beyond},
      {"negative count", in("<parts><part id=\"p\"><validation><count kept=\"^-1\"/></validation></part></parts>"),
       Code::value_integer},
      {"bad hash", in_cell("<import href=\"a.step\" sha256=\"^abc\"/>"), Code::value_sha256},
      {"sections that disagree", in("<parts xmlns:v=\"u\" v:a=\"1\"/>^<parts xmlns:v=\"u\" v:a=\"2\"/>"),
       Code::section_attribute_differs, beyond},
  };
}

std::vector<StructureCase> good_cases() {
  const auto in = in_meso;
  return {
      {"smallest document", in(""), {}},
      {"prefix", "<m:meso xmlns:m=\"urn:meso-format:1.0\" version=\"1.0\" unit=\"inch\"><m:parts/></m:meso>", {}},
      {"sections in any order, repeated", in("<build/><parts/><metadata name=\"a\"/><patterns/><parts/>"), {}},
      {"foreign everywhere",
       in("<v:a xmlns:v=\"u\"/><unitCells><v:a xmlns:v=\"u\">t<b/></v:a><unitCell id=\"c\" xmlns:v=\"u\" v:n=\"1\">"
          "<v:a/><box dx=\"1\" dy=\"1\" dz=\"1\"/><v:a/><csg><v:a/></csg><v:a/></unitCell></unitCells>"),
       {}},
      {"xml:lang", in("<metadata name=\"a\" xml:lang=\"en\">b</metadata>"), {}},
      {"comments and instructions",
       "<?xml version='1.0'?><!--a--><?b c?>" + in("<parts><!--d--></parts>") + "<?e?>",
       {}},
      {"CDATA as text", in("<metadata name=\"a\"><![CDATA[1 < 2]]></metadata>"), {}},
      {"numbers",
       in("<parts><part id=\"p\"><validation><volume value=\"-.5e-3\" tolerance=\"1.\"/><count kept=\"12\"/>"
          "<sample x=\"0\" y=\"+1\" z=\"2\" inside=\"true\"/></validation></part></parts>"),
       {}},
  };
}

}  // namespace

const std::vector<StructureCase>& structure_cases() {
  static const std::vector<StructureCase> all = [] {
    std::vector<StructureCase> out = well_formedness_cases();
    for (auto part : {schema_cases(), good_cases()}) out.insert(out.end(), part.begin(), part.end());
    return out;
  }();
  return all;
}

}  // namespace meso::xml
