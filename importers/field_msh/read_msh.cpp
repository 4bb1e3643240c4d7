// SPDX-License-Identifier: Apache-2.0
// The format is described in Gmsh's manual, "MSH file format" and "MSH file format version 2 (Legacy)".
#include "meso/import_field_msh/read_msh.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <map>
#include <span>
#include <unordered_map>

#include "meso/fields/file_cursor.hpp"
#include "meso/fields/split_cells.hpp"

namespace meso {
namespace {

constexpr std::int64_t most = std::int64_t{1} << 32;

/// Nodes of Gmsh's element types; 0 for those that no solid mesh has.
std::size_t nodes_of(std::int64_t type) {
  static const std::map<std::int64_t, std::size_t> known{
      {1, 2},   {2, 3},   {3, 4},   {4, 4},   {5, 8},   {6, 6},  {7, 5},   {8, 3},   {9, 6},   {10, 9},
      {11, 10}, {12, 27}, {13, 18}, {14, 14}, {15, 1},  {16, 8}, {17, 20}, {18, 15}, {19, 13}, {20, 9},
      {21, 10}, {22, 12}, {23, 15}, {24, 15}, {25, 21}, {26, 4}, {27, 5},  {28, 6},  {29, 20}, {30, 35}};
  const auto found = known.find(type);
  return found == known.end() ? 0 : found->second;
}
bool is_tetra(std::int64_t type) { return type == 4 || type == 11; }
bool is_hexa(std::int64_t type) { return type == 5 || type == 12 || type == 17; }
/// Of a pyramid and a wedge; 0 of others.
std::size_t corners_to_split(std::int64_t type) {
  if (type == 7 || type == 14 || type == 19) return 5;
  return type == 6 || type == 13 || type == 18 ? 6 : 0;
}

constexpr std::uint64_t bytes_per_node = 128;  // its place twice, its number in the table of numbers

struct View {
  std::string name;
  std::size_t width = 0;
  std::vector<double> values;
};

class MshReader {
 public:
  MshReader(std::string_view bytes, const std::string& file, const RunOptions& run, DiagnosticSink& sink)
      : in_(bytes, file, run, sink) {}

  std::optional<fields::Table> read(const std::string& wanted) {
    if (!format()) return std::nullopt;
    while (!in_.at_end()) {
      const std::string_view section = in_.word();
      bool good = true;
      if (section == "$Nodes") {
        in_.line();
        good = is_version_2_ ? nodes_2() : nodes_4();
      } else if (section == "$Elements") {
        in_.line();
        good = is_version_2_ ? elements_2() : elements_4();
      } else if (section == "$NodeData") {
        in_.line();
        good = node_data();
      } else if (section == "$ElementData" || section == "$ElementNodeData") {
        has_element_data_ = true;
      }
      if (!good) return std::nullopt;
      // Sections that are not ours, ends of sections and line ends are walked over word by word.
    }
    if (places_.empty()) {
      in_.empty("nodes");
      return std::nullopt;
    }
    return table(wanted);
  }

 private:
  bool format() {
    double version = 0;
    std::int64_t binary = 0, size = 0;
    if (in_.word() != "$MeshFormat") return in_.expected("$MeshFormat");
    if (!in_.number(version) || !in_.count(binary, 1) || !in_.count(size, 64)) return false;
    in_.line();
    is_version_2_ = version >= 2 && version < 3;
    is_binary_ = binary == 1;
    if (!is_version_2_ && !(version >= 4.1 && version < 5)) return in_.unsupported("this version of the format");
    if (is_version_2_ && is_binary_) return in_.unsupported("the binary form of version 2");
    if (!is_binary_) return true;
    if (size != 8) return in_.unsupported("a size of numbers other than 8");
    std::int32_t one = 0;
    if (!take(&one, sizeof one)) return false;
    return one == 1 || in_.unsupported("the other order of bytes");
  }

  bool take(void* to, std::size_t size) {
    const std::string_view bytes = in_.block(size, "a number");
    if (bytes.size() != size) return false;
    std::memcpy(to, bytes.data(), size);
    return true;
  }
  /// A size_t of the file: 8 bytes in binary.
  bool size(std::int64_t& value, std::int64_t largest = most) {
    if (!is_binary_) return in_.count(value, largest);
    return take(&value, sizeof value) && ((value >= 0 && value <= largest) || in_.expected("a smaller count"));
  }
  bool small(std::int64_t& value) {
    if (!is_binary_) return in_.integer(value);
    std::int32_t small_value = 0;
    const bool good = take(&small_value, sizeof small_value);
    value = small_value;
    return good;
  }
  bool real(double& value) { return is_binary_ ? take(&value, sizeof value) : in_.number(value); }

  bool add_node(std::int64_t tag) {
    if (!in_.takes(bytes_per_node)) return false;
    return row_of_.emplace(tag, row_of_.size()).second || in_.expected("nodes with different numbers");
  }
  bool nodes_2() {
    std::int64_t count = 0;
    if (!in_.count(count, most)) return false;
    for (std::int64_t n = 0; n < count; ++n) {
      std::int64_t tag = 0;
      if (!in_.integer(tag) || !add_node(tag) || !place()) return false;
    }
    return true;
  }
  bool place() {
    for (int i = 0; i < 3; ++i) {
      double value = 0;
      if (!real(value)) return false;
      places_.push_back(value);
    }
    return true;
  }
  bool nodes_4() {
    std::int64_t blocks = 0, all = 0, first = 0, last = 0;
    if (!size(blocks) || !size(all) || !size(first) || !size(last)) return false;
    for (std::int64_t b = 0; b < blocks; ++b) {
      std::int64_t dimension = 0, entity = 0, parametric = 0, count = 0, tag = 0;
      if (!small(dimension) || !small(entity) || !small(parametric) || !size(count)) return false;
      if (parametric != 0) return in_.unsupported("parametric nodes");
      for (std::int64_t n = 0; n < count; ++n) {
        if (!size(tag) || !add_node(tag)) return false;
      }
      for (std::int64_t n = 0; n < count; ++n) {
        if (!place()) return false;
      }
    }
    return true;
  }

  bool corners(std::int64_t type) {
    const std::size_t nodes = nodes_of(type), corners = is_tetra(type) ? 4 : is_hexa(type) ? 8 : corners_to_split(type);
    if (nodes == 0) return in_.unsupported("an element of type " + std::to_string(type));
    std::array<std::int64_t, 8> corner{};
    for (std::size_t i = 0; i < nodes; ++i) {
      std::int64_t tag = 0;
      if (!size(tag)) return false;
      if (i >= corners) continue;
      const auto row = row_of_.find(tag);
      if (row == row_of_.end()) return in_.expected("elements of known nodes");
      corner[i] = static_cast<std::int64_t>(row->second);
    }
    auto& list = is_hexa(type) ? hexa_ : tetra_;
    const std::size_t before = list.size();
    if (corners_to_split(type) > 0)
      append_tetrahedra(corners == 5 ? fields::CellKind::pyramid : fields::CellKind::wedge,
                        std::span(corner).first(corners), list);
    else
      list.insert(list.end(), corner.begin(), corner.begin() + static_cast<std::ptrdiff_t>(corners));
    return list.size() == before || in_.takes((list.size() - before) * sizeof(std::int64_t));
  }
  bool elements_2() {
    std::int64_t count = 0;
    if (!in_.count(count, most)) return false;
    for (std::int64_t n = 0; n < count; ++n) {
      std::int64_t tag = 0, type = 0, tags = 0, unused = 0;
      if (!in_.integer(tag) || !in_.integer(type) || !in_.count(tags, 1000)) return false;
      for (std::int64_t t = 0; t < tags; ++t) {
        if (!in_.integer(unused)) return false;
      }
      if (!corners(type)) return false;
    }
    return true;
  }
  bool elements_4() {
    std::int64_t blocks = 0, all = 0, first = 0, last = 0;
    if (!size(blocks) || !size(all) || !size(first) || !size(last)) return false;
    for (std::int64_t b = 0; b < blocks; ++b) {
      std::int64_t dimension = 0, entity = 0, type = 0, count = 0, tag = 0;
      if (!small(dimension) || !small(entity) || !small(type) || !size(count)) return false;
      for (std::int64_t n = 0; n < count; ++n) {
        if (!size(tag) || !corners(type)) return false;
      }
    }
    return true;
  }

  bool node_data() {
    std::int64_t count = 0, width = 0, entries = 0;
    View view;
    if (!in_.count(count, 1000)) return false;
    in_.line();
    for (std::int64_t i = 0; i < count; ++i) {
      std::string_view text = in_.line();
      if (i > 0) continue;
      if (text.size() >= 2 && text.front() == '"' && text.rfind('"') > 0) text = text.substr(1, text.rfind('"') - 1);
      view.name = std::string(text);
    }
    double time = 0;
    if (!in_.count(count, 1000)) return false;
    for (std::int64_t i = 0; i < count; ++i) {
      if (!in_.number(time)) return false;
    }
    if (!in_.count(count, 1000)) return false;
    for (std::int64_t i = 0; i < count; ++i) {
      std::int64_t value = 0;
      if (!in_.integer(value)) return false;
      if (i == 1) width = value;
      if (i == 2) entries = value;
    }
    in_.line();
    if (width != 1 && width != 3 && width != 9) return in_.expected("1, 3 or 9 numbers for each node");
    view.width = static_cast<std::size_t>(width);
    if (!in_.takes(bytes_of(view.width))) return false;
    view.values.assign(places_.size() / 3 * view.width, std::numeric_limits<double>::quiet_NaN());
    for (std::int64_t n = 0; n < entries; ++n) {
      std::int64_t tag = 0;
      if (!small(tag)) return false;
      const auto row = row_of_.find(tag);
      if (row == row_of_.end()) return in_.expected("values at known nodes");
      for (std::size_t i = 0; i < view.width; ++i) {
        if (!real(view.values[row->second * view.width + i])) return false;
      }
    }
    const auto same = std::find_if(views_.begin(), views_.end(), [&](const View& v) { return v.name == view.name; });
    if (same == views_.end()) {
      views_.push_back(std::move(view));
    } else {
      in_.gives_back(bytes_of(same->width));
      *same = std::move(view);
    }
    return true;
  }
  /// Of a view: its own numbers, and those of the table.
  [[nodiscard]] std::uint64_t bytes_of(std::size_t width) const {
    return 2 * sizeof(double) * std::uint64_t{places_.size() / 3} * width;
  }

  static std::string suffix(std::size_t width, std::size_t i) {
    constexpr const char* letters = "xyz";
    if (width == 1) return {};
    if (width == 3) return {'_', letters[i]};
    return {'_', letters[i / 3], letters[i % 3]};
  }
  std::optional<fields::Table> table(const std::string& wanted) {
    std::erase_if(views_, [&](const View& v) { return !wanted.empty() && v.name != wanted; });
    if (views_.empty() && !wanted.empty()) {
      in_.empty("view '" + wanted + "'");
      return std::nullopt;
    }
    fields::Table result;
    for (const char* name : {"x", "y", "z"}) result.columns.push_back({name, {}});
    for (const View& view : views_) {
      for (std::size_t i = 0; i < view.width; ++i)
        result.columns.push_back({fields::column_name(view.name) + suffix(view.width, i), {}});
    }
    const std::size_t rows = places_.size() / 3;
    // Nodes may stand behind values.
    for (View& view : views_) view.values.resize(rows * view.width, std::numeric_limits<double>::quiet_NaN());
    std::vector<double> values;
    values.reserve(rows * result.columns.size());
    for (std::size_t r = 0; r < rows; ++r) {
      for (std::size_t i = 0; i < 3; ++i) values.push_back(places_[3 * r + i]);
      for (const View& view : views_) {
        for (std::size_t i = 0; i < view.width; ++i) values.push_back(view.values[r * view.width + i]);
      }
    }
    result.records = fields::Records::of(std::move(values), result.columns.size());
    if (has_element_data_) in_.left_out("values of elements");
    result.tetra = std::move(tetra_);
    result.hexa = std::move(hexa_);
    return result;
  }

  fields::FileCursor in_;
  bool is_version_2_ = false, is_binary_ = false, has_element_data_ = false;
  std::vector<double> places_;
  std::unordered_map<std::int64_t, std::size_t> row_of_;  ///< looked up only
  std::vector<std::int64_t> tetra_, hexa_;
  std::vector<View> views_;
};

}  // namespace

std::optional<fields::Table> read_field_msh(std::string_view bytes, const std::string& file, const std::string& view,
                                            const RunOptions& run, DiagnosticSink& sink) {
  return MshReader(bytes, file, run, sink).read(view);
}

}  // namespace meso
