// SPDX-License-Identifier: Apache-2.0
// The legacy form, as "VTK File Formats" describes it. Binary blocks are big-endian.
#include "meso/import_field_vtk/read_vtk.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "vtk_table.hpp"

namespace meso {
namespace {

constexpr std::int64_t most = std::int64_t{1} << 34;

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return result;
}

template <class T>
T from_big_endian(const char* bytes) {
  char turned[sizeof(T)];
  std::reverse_copy(bytes, bytes + sizeof(T), turned);
  T value;
  std::memcpy(&value, turned, sizeof value);
  return value;
}

class VtkReader {
 public:
  VtkReader(std::string_view bytes, const std::string& file, const RunOptions& run, DiagnosticSink& sink)
      : in_(bytes, file, run, sink), size_(bytes.size()) {}

  std::optional<fields::Table> read(const std::string& wanted) {
    if (!in_.line().starts_with("# vtk DataFile Version")) {
      in_.expected("# vtk DataFile Version");
      return std::nullopt;
    }
    in_.line();  // the title
    const std::string form = lower(in_.word());
    is_binary_ = form == "binary";
    if (!is_binary_ && form != "ascii") {
      in_.expected("ASCII or BINARY");
      return std::nullopt;
    }
    if (!data_set() || !geometry() || !attributes()) return std::nullopt;
    return vtk::make_table(std::move(content_), wanted, in_);
  }

 private:
  bool data_set() {
    if (lower(in_.word()) != "dataset") return in_.expected("DATASET");
    kind_ = lower(in_.word());
    static constexpr std::string_view known[] = {"structured_points", "structured_grid", "rectilinear_grid",
                                                 "unstructured_grid", "polydata"};
    if (std::find(std::begin(known), std::end(known), kind_) == std::end(known))
      return in_.unsupported("the data set '" + kind_ + "'");
    return true;
  }

  bool text(double& value) { return in_.number(value); }
  bool text(std::int64_t& value) { return in_.integer(value); }
  /// `T`: what the numbers become, double or int64_t.
  template <class T, class Store>
  bool block(const std::string& type, std::int64_t count, const Store& store) {
    if (!is_binary_) {
      for (std::int64_t i = 0; i < count; ++i) {
        T value = 0;
        if (!text(value) || !in_.takes(2 * sizeof value)) return false;
        store(value);
      }
      return true;
    }
    in_.line();
    if (type == "double") return binary<double>(count, store);
    if (type == "float") return binary<float>(count, store);
    if (type == "int") return binary<std::int32_t>(count, store);
    if (type == "unsigned_int") return binary<std::uint32_t>(count, store);
    if (type == "long" || type == "vtktypeint64") return binary<std::int64_t>(count, store);
    if (type == "short") return binary<std::int16_t>(count, store);
    if (type == "unsigned_short") return binary<std::uint16_t>(count, store);
    if (type == "char") return binary<std::int8_t>(count, store);
    if (type == "unsigned_char") return binary<std::uint8_t>(count, store);
    return in_.unsupported("the type '" + type + "'");
  }
  template <class T, class Store>
  bool binary(std::int64_t count, const Store& store) {
    const std::string_view bytes = in_.block(static_cast<std::uint64_t>(count) * sizeof(T), "numbers");
    if (count > 0 && (bytes.empty() || !in_.takes(2 * sizeof(double) * static_cast<std::uint64_t>(count))))
      return false;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
      store(from_big_endian<T>(bytes.data() + i * sizeof(T)));
    return true;
  }
  bool numbers(const std::string& type, std::int64_t count, std::vector<double>& values) {
    return block<double>(type, count, [&](auto v) { values.push_back(static_cast<double>(v)); });
  }
  bool integers(const std::string& type, std::int64_t count, std::vector<std::int64_t>& values) {
    return block<std::int64_t>(type, count, [&](auto v) { values.push_back(vtk::whole_number(v)); });
  }

  /// Everything up to POINT_DATA.
  bool geometry() {
    std::int64_t size[3]{0, 0, 0};
    double origin[3]{0, 0, 0}, spacing[3]{1, 1, 1};
    const bool is_grid = kind_ == "structured_points" || kind_ == "rectilinear_grid";
    while (true) {
      const std::string word = lower(in_.word());
      if (word.empty() || word == "point_data" || word == "cell_data") {
        section_ = word;
        break;
      }
      bool good = true;
      std::int64_t count = 0;
      if (word == "dimensions") {
        for (std::int64_t& n : size) good = good && in_.count(n, most);
      } else if (word == "origin") {
        for (double& v : origin) good = good && in_.number(v);
      } else if (word == "spacing" || word == "aspect_ratio") {
        for (double& v : spacing) good = good && in_.number(v);
      } else if (kind_ == "rectilinear_grid" && word.ends_with("_coordinates") && word.size() == 13) {
        good = in_.count(count, most) &&
               numbers(lower(in_.word()), count, content_.grid[static_cast<std::size_t>(word[0] - 'x') % 3]);
      } else if (!is_grid && word == "points") {
        good = in_.count(count, most) && numbers(lower(in_.word()), 3 * count, content_.places);
      } else if (word == "cells") {
        good = cells();
      } else if (word == "cell_types") {
        good = in_.count(count, most) && integers("int", count, content_.types);
      } else if (word == "metadata") {
        skip_metadata();
      } else if (kind_ != "polydata") {
        return in_.expected("a part of the data set or POINT_DATA");
      } else {
        good = polydata_part();
      }
      if (!good) return false;
    }
    if (kind_ == "rectilinear_grid")
      for (std::size_t a = 0; a < 3; ++a) size[a] = static_cast<std::int64_t>(content_.grid[a].size());
    // Every point has a value, which takes a byte at least: a few numbers must not fill the memory.
    double points = 1;
    for (const std::int64_t n : size) points *= static_cast<double>(n);
    if (is_grid && points > static_cast<double>(size_)) return in_.expected("data for every point");
    if (is_grid && !in_.takes(static_cast<std::uint64_t>(points) * 6 * sizeof(double))) return false;
    if (kind_ == "structured_points") {
      content_.is_regular = true;
      for (std::size_t a = 0; a < 3; ++a) {
        for (std::int64_t i = 0; i < size[a]; ++i)
          content_.grid[a].push_back(origin[a] + static_cast<double>(i) * spacing[a]);
      }
    }
    if (is_grid) add_grid_points();
    return true;
  }
  void add_grid_points() {
    const auto& [x, y, z] = content_.grid;
    for (const double c : z) {
      for (const double b : y) {
        for (const double a : x) content_.places.insert(content_.places.end(), {a, b, c});
      }
    }
  }
  /// VERTICES, LINES, POLYGONS and the like: only their points matter.
  bool polydata_part() {
    std::int64_t count = 0, size = 0;
    std::vector<std::int64_t> unused;
    if (!in_.count(count, most) || !in_.count(size, most)) return false;
    if (lower(in_.peek()) != "offsets") return integers("int", size, unused);
    in_.word();
    if (!integers(lower(in_.word()), count, unused)) return false;
    if (lower(in_.word()) != "connectivity") return in_.expected("CONNECTIVITY");
    return integers(lower(in_.word()), size, unused);
  }
  bool cells() {
    std::int64_t first = 0, second = 0;
    if (!in_.count(first, most) || !in_.count(second, most)) return false;
    if (lower(in_.peek()) == "offsets") {
      in_.word();
      if (!integers(lower(in_.word()), first, content_.offsets)) return false;
      if (lower(in_.word()) != "connectivity") return in_.expected("CONNECTIVITY");
      return integers(lower(in_.word()), second, content_.connectivity);
    }
    std::vector<std::int64_t> list;
    if (!integers("int", second, list)) return false;
    content_.offsets.push_back(0);
    for (std::size_t at = 0; at < list.size();) {
      const std::int64_t points = list[at++];
      if (points < 0 || points > static_cast<std::int64_t>(list.size() - at)) return in_.expected("whole cells");
      for (std::int64_t i = 0; i < points; ++i) content_.connectivity.push_back(list[at++]);
      content_.offsets.push_back(static_cast<std::int64_t>(content_.connectivity.size()));
    }
    return true;
  }
  void skip_metadata() {
    in_.line();
    while (!in_.at_end() && !in_.line().empty()) {
    }
  }

  bool attributes() {
    // Values of cells are walked over where those of points may follow.
    while (!section_.empty()) {
      const bool is_points = section_ == "point_data";
      content_.has_cell_values = content_.has_cell_values || !is_points;
      if (!is_points && !content_.arrays.empty()) break;
      if (!section(is_points)) return false;
    }
    return content_.types.empty() || cells_fit();
  }
  /// Up to the next one.
  bool section(bool is_points) {
    std::int64_t count = 0;
    if (!in_.count(count, most)) return false;
    if (is_points && count * 3 != static_cast<std::int64_t>(content_.places.size()))
      return in_.expected("data for every point");
    while (true) {
      section_ = lower(in_.word());
      if (section_.empty() || section_ == "point_data" || section_ == "cell_data") break;
      if (section_ == "metadata")
        skip_metadata();
      else if (!attribute(section_, count))
        return false;
    }
    if (!is_points) content_.arrays.clear();
    return true;
  }
  bool cells_fit() {
    return content_.offsets.size() == content_.types.size() + 1 || in_.expected("a type for every cell");
  }

  bool attribute(const std::string& word, std::int64_t count) {
    if (word == "field") {
      std::int64_t arrays = 0;
      in_.word();
      if (!in_.count(arrays, 10000)) return false;
      for (std::int64_t i = 0; i < arrays; ++i) {
        std::string name(in_.word());
        if (lower(name) == "metadata") {
          skip_metadata();
          name = in_.word();
        }
        std::int64_t width = 0, tuples = 0;
        if (!in_.count(width, 10000) || !in_.count(tuples, most)) return false;
        if (!array(std::move(name), lower(in_.word()), width, tuples)) return false;
      }
      return true;
    }
    std::string name(in_.word());
    std::int64_t width = 1;
    if (word == "vectors" || word == "normals") return array(std::move(name), lower(in_.word()), 3, count);
    if (word == "tensors") return array(std::move(name), lower(in_.word()), 9, count);
    if (word == "tensors6") return array(std::move(name), lower(in_.word()), 6, count);
    if (word == "scalars") {
      const std::string type = lower(in_.word());
      if (lower(in_.peek()) != "lookup_table" && !in_.count(width, 4)) return false;
      if (lower(in_.word()) != "lookup_table") return in_.expected("LOOKUP_TABLE");
      in_.word();
      return array(std::move(name), type, width, count);
    }
    if (word == "lookup_table") {
      std::vector<std::int64_t> unused;
      std::int64_t size = 0;
      return in_.count(size, most) && integers(is_binary_ ? "unsigned_char" : "float", 4 * size, unused);
    }
    return in_.unsupported("the attribute '" + word + "'");
  }
  bool array(std::string name, const std::string& type, std::int64_t width, std::int64_t tuples) {
    vtk::Array array{std::move(name), static_cast<std::size_t>(width), {}};
    if (width == 0 || !numbers(type, width * tuples, array.values)) return width == 0 && in_.expected("a width");
    content_.arrays.push_back(std::move(array));
    return true;
  }

  fields::FileCursor in_;
  std::size_t size_;
  bool is_binary_ = false;
  std::string kind_, section_;
  vtk::Content content_;
};

}  // namespace

std::optional<fields::Table> read_field_vtk(std::string_view bytes, const std::string& file, const std::string& array,
                                            const RunOptions& run, DiagnosticSink& sink) {
  return VtkReader(bytes, file, run, sink).read(array);
}

}  // namespace meso
