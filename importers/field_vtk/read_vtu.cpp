// SPDX-License-Identifier: Apache-2.0
// Unstructured grids in XML: "VTK File Formats", section XML. Expat reads the elements, zlib unpacks the blocks.
#include <expat.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <memory>

#include "meso/fields/base64.hpp"
#include "meso/import_field_vtk/read_vtk.hpp"
#include "vtk_table.hpp"

namespace meso {
namespace {

constexpr std::uint64_t most_bytes = std::uint64_t{1} << 40;

struct DataArray {
  std::string group, name, type, format;
  std::size_t width = 1;
  std::uint64_t offset = 0;
  std::string text;
};

using Attributes = std::map<std::string, std::string, std::less<>>;

class VtuReader {
 public:
  VtuReader(std::string_view bytes, const std::string& file, const RunOptions& run, DiagnosticSink& sink)
      : in_(bytes, file, run, sink), bytes_(bytes), file_(file), run_(run), sink_(sink) {}

  std::optional<fields::Table> read(const std::string& wanted) {
    if (!parse()) return std::nullopt;
    if (type_ != "UnstructuredGrid") {
      in_.unsupported("the type '" + type_ + "' of a VTKFile (UnstructuredGrid is read)");
      return std::nullopt;
    }
    if (pieces_ != 1) {
      in_.unsupported(std::to_string(pieces_) + " pieces in place of one");
      return std::nullopt;
    }
    if (is_big_endian_ || (!compressor_.empty() && compressor_ != "vtkZLibDataCompressor")) {
      in_.unsupported(is_big_endian_ ? "big-endian data" : "the compressor '" + compressor_ + "'");
      return std::nullopt;
    }
    for (DataArray& array : arrays_) {
      const std::uint64_t text_bytes = array.text.size();
      if (!store(array)) return std::nullopt;
      in_.gives_back(text_bytes);
      array.text = {};
    }
    if (!content_.types.empty() && content_.offsets.size() != content_.types.size() + 1) {
      in_.expected("a type for every cell");
      return std::nullopt;
    }
    return vtk::make_table(std::move(content_), wanted, in_);
  }

 private:
  // Appended raw bytes are no XML: Expat gets what stands before them, and the tags that close it.
  bool parse() {
    const std::size_t appended = bytes_.find("<AppendedData");
    std::string_view xml = bytes_;
    std::string closing;
    if (appended != std::string_view::npos) {
      const std::size_t end = bytes_.find('>', appended), mark = bytes_.find('_', end);
      if (end == std::string_view::npos || mark == std::string_view::npos) {
        in_.move_to(bytes_.size());
        in_.word();
        return in_.expected("_ and appended data");
      }
      xml = bytes_.substr(0, end + 1);
      closing = "</AppendedData></VTKFile>";
      const std::size_t last = bytes_.rfind("</AppendedData");
      appended_ = bytes_.substr(mark + 1, last == std::string_view::npos || last < mark ? last : last - mark - 1);
    }
    const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(XML_ParserCreate(nullptr),
                                                                              XML_ParserFree);
    XML_SetUserData(parser.get(), this);
    XML_SetElementHandler(parser.get(), &VtuReader::begin, &VtuReader::end);
    XML_SetCharacterDataHandler(parser.get(), &VtuReader::characters);
    // Entities could make much out of little, or name other files.
    XML_SetStartDoctypeDeclHandler(parser.get(), &VtuReader::doctype);
    parser_ = parser.get();
    constexpr std::size_t piece = std::size_t{1} << 24;
    bool good = true;
    for (std::size_t at = 0; good && at < xml.size(); at += piece) {
      if (in_.is_stopped()) return false;
      const std::string_view part = xml.substr(at, piece);
      good = XML_Parse(parser.get(), part.data(), static_cast<int>(part.size()), 0) == XML_STATUS_OK;
    }
    good = good && XML_Parse(parser.get(), closing.data(), static_cast<int>(closing.size()), 1) == XML_STATUS_OK;
    if (good) return true;
    if (in_.is_stopped()) return false;
    if (has_doctype_) return in_.unsupported("a DOCTYPE");
    sink_.report({.code = Code::field_file_syntax,
                  .where = {.file = file_,
                            .line = static_cast<std::size_t>(XML_GetCurrentLineNumber(parser.get())),
                            .column = static_cast<std::size_t>(XML_GetCurrentColumnNumber(parser.get())) + 1},
                  .args = {"well-formed XML", XML_ErrorString(XML_GetErrorCode(parser.get()))}});
    return false;
  }

  static void begin(void* self, const XML_Char* name, const XML_Char** attributes) {
    Attributes all;
    for (; *attributes != nullptr; attributes += 2) all.emplace(attributes[0], attributes[1]);
    static_cast<VtuReader*>(self)->begin_element(name, std::move(all));
  }
  void begin_element(const std::string& name, Attributes all) {
    if (name == "VTKFile") {
      type_ = all["type"];
      compressor_ = all["compressor"];
      is_big_endian_ = all["byte_order"] == "BigEndian";
      header_bytes_ = all["header_type"] == "UInt64" ? 8 : 4;
    } else if (name == "Piece") {
      ++pieces_;
    } else if (name == "AppendedData") {
      is_appended_raw_ = all["encoding"] == "raw";
    } else if (name == "Points" || name == "Cells" || name == "PointData" || name == "CellData") {
      group_ = name;
    } else if (is_in_array_) {
      ++inner_;  // an InformationKey: its text is no data
    } else if (name == "DataArray" && group_ == "CellData") {
      content_.has_cell_values = true;
    } else if (name == "DataArray" && !group_.empty()) {
      DataArray array{group_, all["Name"], all["type"], all["format"], 1, 0, {}};
      std::int64_t number = 0;
      if (fields::parse_field_integer(all["NumberOfComponents"], number) && number > 0)
        array.width = static_cast<std::size_t>(number);
      if (fields::parse_field_integer(all["offset"], number) && number >= 0)
        array.offset = static_cast<std::uint64_t>(number);
      arrays_.push_back(std::move(array));
      is_in_array_ = true;
    }
  }
  static void doctype(void* self, const XML_Char*, const XML_Char*, const XML_Char*, int) {
    auto& reader = *static_cast<VtuReader*>(self);
    reader.has_doctype_ = true;
    XML_StopParser(reader.parser_, XML_FALSE);
  }
  static void end(void* self, const XML_Char* name) {
    auto& reader = *static_cast<VtuReader*>(self);
    if (std::strcmp(name, "DataArray") == 0)
      reader.is_in_array_ = false;
    else if (reader.is_in_array_)
      --reader.inner_;
    if (name == reader.group_) reader.group_.clear();
  }
  static void characters(void* self, const XML_Char* text, int size) {
    auto& reader = *static_cast<VtuReader*>(self);
    if (!reader.is_in_array_ || reader.inner_ > 0) return;
    if (reader.in_.takes(static_cast<std::uint64_t>(size)))
      reader.arrays_.back().text.append(text, static_cast<std::size_t>(size));
    else
      XML_StopParser(reader.parser_, XML_FALSE);
  }

  bool fault(const DataArray& array, std::string what) {
    sink_.report({.code = Code::field_file_syntax,
                  .where = {.file = file_},
                  .args = {"good data in the array '" + array.name + "'", std::move(what)}});
    return false;
  }
  std::uint64_t header(const std::string& bytes, std::size_t i) const {
    std::uint64_t value = 0;
    std::memcpy(&value, bytes.data() + i * header_bytes_, header_bytes_);
    return value;
  }

  /// The first `size` bytes behind `at` of base64 text or raw bytes, which `at` moves behind.
  bool take(std::string_view source, bool is_base64, std::size_t& at, std::uint64_t size, std::string& bytes) const {
    if (size > most_bytes) return false;
    if (!is_base64) {
      if (at > source.size() || size > source.size() - at) return false;
      bytes = source.substr(at, static_cast<std::size_t>(size));
      at += static_cast<std::size_t>(size);
      return true;
    }
    const std::size_t letters = (static_cast<std::size_t>(size) + 2) / 3 * 4;
    if (at > source.size() || letters > source.size() - at) return false;
    bytes.resize(fields::base64_bytes_at_most(letters));
    const auto decoded = fields::decode_base64(source.substr(at, letters), reinterpret_cast<std::byte*>(bytes.data()));
    at += letters;
    if (!decoded || *decoded < size) return false;
    bytes.resize(static_cast<std::size_t>(size));
    return true;
  }

  /// Base64 or raw, a header, blocks that may be packed.
  bool binary(DataArray& array, std::string& bytes) {
    const bool is_appended = array.format == "appended";
    std::string_view source = appended_;
    std::size_t at = static_cast<std::size_t>(array.offset);
    if (!is_appended) {
      std::erase_if(array.text, [](char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; });
      source = array.text;
      at = 0;
    }
    const bool is_base64 = !is_appended || !is_appended_raw_;
    std::string head;
    if (compressor_.empty()) {
      // One base64 text for header and data.
      std::size_t from = at;
      if (!take(source, is_base64, from, header_bytes_, head)) return fault(array, "too few bytes");
      const std::uint64_t size = header(head, 0);
      if (size > most_bytes || !take(source, is_base64, at, header_bytes_ + size, bytes))
        return fault(array, "fewer bytes than its header states");
      bytes.erase(0, header_bytes_);
      return in_.takes(size);
    }
    std::size_t from = at;
    if (!take(source, is_base64, from, header_bytes_, head)) return fault(array, "too few bytes");
    const std::uint64_t blocks = header(head, 0);
    if (blocks > (std::uint64_t{1} << 32) || !take(source, is_base64, at, (3 + blocks) * header_bytes_, head))
      return fault(array, "fewer bytes than its header states");
    const std::uint64_t block = header(head, 1), last = header(head, 2);
    std::uint64_t packed = 0;
    for (std::uint64_t i = 0; i < blocks; ++i) {
      if (__builtin_add_overflow(packed, header(head, 3 + static_cast<std::size_t>(i)), &packed))
        return fault(array, "fewer bytes than its header states");
    }
    std::string data;
    if (block > most_bytes || !take(source, is_base64, at, packed, data))
      return fault(array, "fewer bytes than its header states");
    std::size_t begin = 0;
    for (std::uint64_t i = 0; i < blocks; ++i) {
      const std::uint64_t size = i + 1 == blocks && last > 0 ? last : block;
      const auto in_size = static_cast<std::size_t>(header(head, 3 + static_cast<std::size_t>(i)));
      // zlib never makes a byte out of less than a thousandth of one: a header that says so lies.
      if (in_size > data.size() - begin || size > 1100 * (in_size + 1))
        return fault(array, "blocks that cannot hold what their header states");
      if (!in_.takes(size) || in_.is_stopped()) return false;
      const std::size_t old = bytes.size();
      bytes.resize(old + static_cast<std::size_t>(size));
      uLongf written = static_cast<uLongf>(size);
      if (uncompress(reinterpret_cast<Bytef*>(bytes.data() + old), &written,
                     reinterpret_cast<const Bytef*>(data.data() + begin), static_cast<uLong>(in_size)) != Z_OK ||
          written != size)
        return fault(array, "damaged blocks");
      begin += in_size;
    }
    return true;
  }

  template <class T, class Store>
  bool each(const DataArray& array, const std::string& bytes, const Store& store) {
    if (bytes.size() % sizeof(T) != 0) return fault(array, "a part of a number");
    if (!in_.takes(bytes.size() / sizeof(T) * 2 * sizeof(double))) return false;
    for (std::size_t i = 0; i < bytes.size(); i += sizeof(T)) {
      T value;
      std::memcpy(&value, bytes.data() + i, sizeof value);
      store(value);
    }
    return true;
  }
  template <class Store>
  bool numbers(DataArray& array, const Store& put) {
    if (in_.is_stopped()) return false;
    if (array.format == "ascii") {
      fields::FileCursor text(array.text, file_ + ", array '" + array.name + "'", run_, sink_);
      while (!text.peek().empty()) {
        double value = 0;
        if (!text.number(value) || !in_.takes(2 * sizeof value)) return false;
        put(value);
      }
      return true;
    }
    std::string bytes;
    if (array.format != "binary" && array.format != "appended")
      return fault(array, "the format '" + array.format + "'");
    if (!binary(array, bytes) || !stored(array, bytes, put)) return false;
    in_.gives_back(bytes.size());
    return true;
  }
  template <class Store>
  bool stored(const DataArray& array, const std::string& bytes, const Store& put) {
    if (array.type == "Float64") return each<double>(array, bytes, put);
    if (array.type == "Float32") return each<float>(array, bytes, put);
    if (array.type == "Int64") return each<std::int64_t>(array, bytes, put);
    if (array.type == "UInt64") return each<std::uint64_t>(array, bytes, put);
    if (array.type == "Int32") return each<std::int32_t>(array, bytes, put);
    if (array.type == "UInt32") return each<std::uint32_t>(array, bytes, put);
    if (array.type == "Int16") return each<std::int16_t>(array, bytes, put);
    if (array.type == "UInt16") return each<std::uint16_t>(array, bytes, put);
    if (array.type == "Int8") return each<std::int8_t>(array, bytes, put);
    if (array.type == "UInt8") return each<std::uint8_t>(array, bytes, put);
    return fault(array, "the type '" + array.type + "'");
  }

  bool store(DataArray& array) {
    const auto reals = [](std::vector<double>& to) { return [&to](auto v) { to.push_back(static_cast<double>(v)); }; };
    const auto wholes = [](std::vector<std::int64_t>& to) {
      return [&to](auto v) { to.push_back(vtk::whole_number(v)); };
    };
    if (array.group == "Points") return numbers(array, reals(content_.places));
    if (array.group == "Cells") {
      if (array.name == "connectivity") return numbers(array, wholes(content_.connectivity));
      if (array.name == "types") return numbers(array, wholes(content_.types));
      if (array.name != "offsets") return true;
      content_.offsets.push_back(0);
      return numbers(array, wholes(content_.offsets));
    }
    content_.arrays.push_back({array.name, array.width, {}});
    return numbers(array, reals(content_.arrays.back().values));
  }

  fields::FileCursor in_;
  std::string_view bytes_, appended_;
  std::string file_;
  const RunOptions& run_;
  DiagnosticSink& sink_;
  XML_Parser parser_ = nullptr;
  bool has_doctype_ = false;
  std::string type_, compressor_, group_;
  bool is_big_endian_ = false, is_appended_raw_ = false, is_in_array_ = false;
  std::size_t header_bytes_ = 4;
  int pieces_ = 0, inner_ = 0;
  std::vector<DataArray> arrays_;
  vtk::Content content_;
};

}  // namespace

std::optional<fields::Table> read_field_vtu(std::string_view bytes, const std::string& file, const std::string& array,
                                            const RunOptions& run, DiagnosticSink& sink) {
  return VtuReader(bytes, file, run, sink).read(array);
}

}  // namespace meso
