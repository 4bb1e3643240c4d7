// SPDX-License-Identifier: Apache-2.0
// The format is described in CalculiX GraphiX's manual, "Result Format": records are known by a key in the first six
// columns, numbers stand in fixed columns and may touch.
#include "meso/import_field_frd/read_frd.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <unordered_map>

#include "meso/fields/file_cursor.hpp"
#include "meso/fields/split_cells.hpp"

namespace meso {
namespace {

enum class Form { short_text = 0, long_text = 1, floats = 2, doubles = 3 };

constexpr std::uint64_t bytes_per_node = 128;  // its place twice, its number in the table of numbers

/// Nodes of the element types 1 to 12.
constexpr std::size_t element_nodes[] = {8, 6, 4, 20, 15, 10, 3, 6, 4, 8, 2, 3};

std::string_view columns(std::string_view line, std::size_t first, std::size_t size) {
  return first < line.size() ? line.substr(first, size) : std::string_view();
}
std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == std::string_view::npos ? std::string_view()
                                         : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

struct DataSet {
  std::string name;
  std::vector<std::string> components;
  std::vector<double> values;
};

class FrdReader {
 public:
  FrdReader(std::string_view bytes, const std::string& file, const RunOptions& run, DiagnosticSink& sink)
      : in_(bytes, file, run, sink) {}

  std::optional<fields::Table> read(const std::string& wanted) {
    while (!in_.at_end()) {
      const std::string_view line = in_.line();
      const std::string_view key = trimmed(columns(line, 0, 6));
      bool good = true;
      if (key == "2C") good = nodes(line);
      if (key == "3C") good = elements(line);
      if (key == "100C" || key.starts_with("100C")) good = results(line);
      if (!good) return std::nullopt;
      if (key == "9999") break;
    }
    if (places_.empty()) {
      in_.empty("nodes");
      return std::nullopt;
    }
    return table(wanted);
  }

 private:
  /// Number of entries and their form, from a block's first line.
  bool header(std::string_view line, std::int64_t& count, Form& form) {
    std::int64_t format = 0;
    if (!fields::parse_field_integer(columns(line, 24, 12), count) || count < 0 ||
        !fields::parse_field_integer(columns(line, 73, 2), format) || format < 0 || format > 3)
      return in_.expected("a count in columns 25 to 36 and a format from 0 to 3 in columns 74 and 75");
    form = static_cast<Form>(format);
    return true;
  }
  static bool is_text(Form form) { return form == Form::short_text || form == Form::long_text; }
  static std::size_t id_width(Form form) { return form == Form::short_text ? 5 : 10; }

  /// Reads entries "-1 id numbers" with continuations "-2 numbers" until "-3", or as many binary records.
  template <class Store>
  bool rows(Form form, std::int64_t count, std::size_t width, const Store& store) {
    std::vector<double> values(width);
    if (!is_text(form)) return binary_rows(form, count, values, store);
    for (std::int64_t found = 0;; ++found) {
      if (in_.at_end()) return in_.expected("-3");
      std::string_view line = in_.line();
      const std::string_view key = trimmed(columns(line, 0, 3));
      if (key == "-3") return found == count || in_.expected(std::to_string(count) + " entries before it");
      std::int64_t id = 0;
      if (key != "-1" || !fields::parse_field_integer(columns(line, 3, id_width(form)), id))
        return in_.expected("-1 and a number of a node");
      for (std::size_t i = 0, at = 3 + id_width(form); i < width; ++i, at += 12) {
        if (i > 0 && i % 6 == 0) {
          line = in_.line();
          if (trimmed(columns(line, 0, 3)) != "-2") return in_.expected("-2");
          at = 3 + id_width(form);
        }
        if (!fields::parse_field_number(columns(line, at, 12), values[i]))
          return in_.expected("numbers in columns of 12");
      }
      if (!store(id, values)) return false;
    }
  }
  template <class Store>
  bool binary_rows(Form form, std::int64_t count, std::vector<double>& values, const Store& store) {
    const std::size_t size = form == Form::floats ? sizeof(float) : sizeof(double);
    for (std::int64_t n = 0; n < count; ++n) {
      const std::string_view record = in_.block(sizeof(std::int32_t) + size * values.size(), "a record");
      if (record.empty()) return false;
      std::int32_t id = 0;
      std::memcpy(&id, record.data(), sizeof id);
      for (std::size_t i = 0; i < values.size(); ++i) {
        const char* from = record.data() + sizeof id + i * size;
        float single = 0;
        if (form == Form::floats) {
          std::memcpy(&single, from, size);
          values[i] = static_cast<double>(single);
        } else {
          std::memcpy(&values[i], from, size);
        }
      }
      if (!store(id, values)) return false;
    }
    return true;
  }

  bool nodes(std::string_view line) {
    std::int64_t count = 0;
    Form form{};
    return header(line, count, form) && rows(form, count, 3, [&](std::int64_t id, const std::vector<double>& p) {
             if (!in_.takes(bytes_per_node)) return false;
             if (!row_of_.emplace(id, places_.size() / 3).second) return in_.expected("nodes with different numbers");
             places_.insert(places_.end(), p.begin(), p.end());
             return true;
           });
  }

  bool add_element(std::int64_t type, const std::vector<std::int64_t>& ids) {
    const bool is_tetra = type == 3 || type == 6, is_hexa = type == 1 || type == 4, is_wedge = type == 2 || type == 5;
    if (!is_tetra && !is_hexa && !is_wedge) return true;
    std::array<std::int64_t, 8> corner{};
    const std::size_t corners = is_tetra ? 4 : is_hexa ? 8 : 6;
    for (std::size_t i = 0; i < corners; ++i) {
      const auto row = row_of_.find(ids[i]);
      if (row == row_of_.end()) return in_.expected("elements of known nodes");
      corner[i] = static_cast<std::int64_t>(row->second);
    }
    auto& list = is_hexa ? hexa_ : tetra_;
    const std::size_t before = list.size();
    if (is_wedge)
      append_tetrahedra(fields::CellKind::wedge, std::span(corner).first(corners), list);
    else
      list.insert(list.end(), corner.begin(), corner.begin() + static_cast<std::ptrdiff_t>(corners));
    return in_.takes((list.size() - before) * sizeof(std::int64_t));
  }
  bool elements(std::string_view line) {
    std::int64_t count = 0;
    Form form{};
    if (!header(line, count, form)) return false;
    std::vector<std::int64_t> ids;
    for (std::int64_t n = 0; n < count; ++n) {
      std::int64_t type = 0;
      if (is_text(form)) {
        const std::string_view head = in_.line();
        if (trimmed(columns(head, 0, 3)) != "-1" ||
            !fields::parse_field_integer(columns(head, 3 + id_width(form), 5), type) || type < 1 || type > 12)
          return in_.expected("-1, an element's number and a type from 1 to 12");
        ids.resize(element_nodes[type - 1]);
        const std::size_t per_line = form == Form::short_text ? 15 : 10;
        std::string_view list;
        for (std::size_t i = 0; i < ids.size(); ++i) {
          if (i % per_line == 0) list = in_.line();
          if (trimmed(columns(list, 0, 3)) != "-2" ||
              !fields::parse_field_integer(columns(list, 3 + id_width(form) * (i % per_line), id_width(form)), ids[i]))
            return in_.expected("-2 and numbers of nodes");
        }
      } else {
        std::int32_t head[4]{};
        const std::string_view bytes = in_.block(sizeof head, "an element");
        if (bytes.empty()) return false;
        std::memcpy(head, bytes.data(), sizeof head);
        type = head[1];
        if (type < 1 || type > 12) return in_.expected("an element type from 1 to 12");
        ids.resize(element_nodes[type - 1]);
        const std::string_view list = in_.block(sizeof(std::int32_t) * ids.size(), "an element");
        if (list.empty()) return false;
        for (std::size_t i = 0; i < ids.size(); ++i) {
          std::int32_t id = 0;
          std::memcpy(&id, list.data() + i * sizeof id, sizeof id);
          ids[i] = id;
        }
      }
      if (!add_element(type, ids)) return false;
    }
    return true;
  }

  bool results(std::string_view line) {
    std::int64_t count = 0;
    Form form{};
    if (!header(line, count, form)) return false;
    const std::string_view head = in_.line();
    std::int64_t declared = 0;
    if (trimmed(columns(head, 0, 3)) != "-4" || !fields::parse_field_integer(columns(head, 13, 5), declared) ||
        declared < 1 || declared > 1000)
      return in_.expected("-4, a name and a number of components");
    DataSet set;
    set.name = std::string(trimmed(columns(head, 5, 8)));
    for (std::int64_t c = 0; c < declared; ++c) {
      const std::string_view component = in_.line();
      if (trimmed(columns(component, 0, 3)) != "-5") return in_.expected("-5 and a component");
      std::int64_t is_derived = 0;
      if (!trimmed(columns(component, 33, 5)).empty() &&
          !fields::parse_field_integer(columns(component, 33, 5), is_derived))
        return in_.expected("a flag in columns 34 to 38");
      if (is_derived != 1) set.components.emplace_back(trimmed(columns(component, 5, 8)));
    }
    const std::size_t width = set.components.size();
    if (!in_.takes(bytes_of(width))) return false;
    set.values.assign(places_.size() / 3 * width, std::numeric_limits<double>::quiet_NaN());
    const bool good = rows(form, count, width, [&](std::int64_t id, const std::vector<double>& values) {
      const auto row = row_of_.find(id);
      if (row == row_of_.end()) return in_.expected("values at known nodes");
      std::copy(values.begin(), values.end(), set.values.begin() + static_cast<std::ptrdiff_t>(row->second * width));
      return true;
    });
    if (!good) return false;
    const auto same = std::find_if(sets_.begin(), sets_.end(), [&](const DataSet& s) { return s.name == set.name; });
    if (same == sets_.end()) {
      sets_.push_back(std::move(set));
    } else {
      in_.gives_back(bytes_of(same->components.size()));
      *same = std::move(set);
    }
    return true;
  }
  /// Of a data set: its own numbers, and those of the table.
  [[nodiscard]] std::uint64_t bytes_of(std::size_t width) const {
    return 2 * sizeof(double) * std::uint64_t{places_.size() / 3} * width;
  }

  std::optional<fields::Table> table(const std::string& wanted) {
    const std::size_t rows = places_.size() / 3;
    std::vector<const DataSet*> taken;
    for (DataSet& set : sets_) {
      // Nodes may stand behind results.
      set.values.resize(rows * set.components.size(), std::numeric_limits<double>::quiet_NaN());
      if (wanted.empty() || set.name == wanted) taken.push_back(&set);
    }
    if (taken.empty() && !wanted.empty()) {
      in_.empty("data set '" + wanted + "'");
      return std::nullopt;
    }
    fields::Table result;
    for (const char* name : {"x", "y", "z"}) result.columns.push_back({name, {}});
    for (const DataSet* set : taken) {
      for (const std::string& component : set->components) {
        std::string name = fields::column_name(component);
        const bool is_known = std::any_of(result.columns.begin(), result.columns.end(),
                                          [&](const fields::Column& c) { return c.name == name; });
        result.columns.push_back({is_known ? fields::column_name(set->name) + "_" + name : name, {}});
      }
    }
    std::vector<double> values;
    values.reserve(rows * result.columns.size());
    for (std::size_t r = 0; r < rows; ++r) {
      for (std::size_t i = 0; i < 3; ++i) values.push_back(places_[3 * r + i]);
      for (const DataSet* set : taken) {
        const std::size_t width = set->components.size();
        for (std::size_t c = 0; c < width; ++c) values.push_back(set->values[r * width + c]);
      }
    }
    result.records = fields::Records::of(std::move(values), result.columns.size());
    result.tetra = std::move(tetra_);
    result.hexa = std::move(hexa_);
    return result;
  }

  fields::FileCursor in_;
  std::vector<double> places_;
  std::unordered_map<std::int64_t, std::size_t> row_of_;  ///< looked up only
  std::vector<std::int64_t> tetra_, hexa_;
  std::vector<DataSet> sets_;
};

}  // namespace

std::optional<fields::Table> read_field_frd(std::string_view bytes, const std::string& file,
                                            const std::string& data_set, const RunOptions& run, DiagnosticSink& sink) {
  return FrdReader(bytes, file, run, sink).read(data_set);
}

}  // namespace meso
