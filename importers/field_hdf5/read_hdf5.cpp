// SPDX-License-Identifier: Apache-2.0
#include "meso/import_field_hdf5/read_hdf5.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <utility>

#include "meso/fields/number_block.hpp"
#include "meso/hdf5/handle.hpp"

namespace meso {
namespace {

using hdf5::Handle;

constexpr hsize_t block_values = hsize_t{1} << 22;  // 32 MiB between two looks at the clock
constexpr hsize_t most_columns = 10'000;
constexpr hsize_t most_unpacked = 2000;  // bytes of doubles out of a packed one: deflate makes up to 1032 of bytes
constexpr std::size_t most_text_bytes = std::size_t{1} << 16;  // of an attribute

struct DataSet {
  std::string name;
  Handle set, type;
  hsize_t rows = 0, columns = 1;
  std::vector<std::string> components, units;
};

using Texts = std::vector<std::string>;

/// Ends every text with a zero byte.
bool write_all(int out, const Texts& texts) {
  std::string bytes;
  for (const std::string& text : texts) bytes += text.substr(0, text.find('\0')) + '\0';
  if (bytes.size() > most_text_bytes) return true;  // more than names of columns are: none
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t wrote = ::write(out, bytes.data() + done, bytes.size() - done);
    if (wrote < 0) return false;
    done += static_cast<std::size_t>(wrote);
  }
  return true;
}

Texts read_all(int in) {
  Texts result;
  std::string text;
  std::array<char, 4096> block{};
  for (;;) {
    const ssize_t count = ::read(in, block.data(), block.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return result;
    for (const char c : std::string_view(block.data(), static_cast<std::size_t>(count))) {
      if (c != '\0')
        text += c;
      else
        result.push_back(std::exchange(text, {}));
    }
  }
}

bool convert_variable(hid_t attribute, hid_t type, std::size_t count, int out) {
  std::vector<char*> texts(count, nullptr);
  if (H5Aread(attribute, type, texts.data()) < 0) return false;
  Texts copies;
  for (const char* text : texts) copies.emplace_back(text != nullptr ? text : "");
  return write_all(out, copies);
}

/// HDF5 1.10 trusts the lengths of damaged texts of variable length: it ends the process, or never ends. So a process
/// of its own reads them. It calls nothing but HDF5, whose lock this thread holds, and `write`. Absent where it could
/// not.
std::optional<Texts> variable_texts(hid_t attribute, hid_t type, std::size_t count) {
  constexpr rlim_t seconds = 1;
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return std::nullopt;
  const pid_t child = ::fork();
  if (child == 0) {
    for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE}) std::signal(signal, SIG_DFL);
    const rlimit none{0, 0}, time{seconds, seconds};
    ::setrlimit(RLIMIT_CORE, &none);
    ::setrlimit(RLIMIT_CPU, &time);
    ::_exit(convert_variable(attribute, type, count, ends[1]) ? 0 : 1);
  }
  ::close(ends[1]);
  std::optional<Texts> result;
  int status = -1;
  if (child > 0) {
    result = read_all(ends[0]);
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
  }
  ::close(ends[0]);
  if (status != 0) return std::nullopt;
  return result;
}

/// Empty where there is no such attribute of texts, or a larger one than names of columns are; absent where it is
/// damaged.
std::optional<Texts> texts_of(hid_t object, const char* attribute) {
  Texts result;
  if (H5Aexists(object, attribute) <= 0) return result;
  const Handle a(H5Aopen(object, attribute, H5P_DEFAULT), H5Aclose);
  if (!a) return std::nullopt;
  const Handle space(H5Aget_space(a.id()), H5Sclose), type(H5Aget_type(a.id()), H5Tclose);
  const hssize_t count = H5Sget_simple_extent_npoints(space.id());
  const std::size_t size = H5Tget_size(type.id());
  if (count < 1 || H5Tget_class(type.id()) != H5T_STRING || size == 0 ||
      static_cast<std::size_t>(count) > most_text_bytes / size)
    return result;
  if (H5Tis_variable_str(type.id()) > 0) return variable_texts(a.id(), type.id(), static_cast<std::size_t>(count));
  std::string bytes(size * static_cast<std::size_t>(count), '\0');
  if (H5Aread(a.id(), type.id(), bytes.data()) < 0) return std::nullopt;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    std::string text = bytes.substr(i * size, size);
    text.resize(std::min(text.find('\0'), text.size()));
    text.resize(text.find_last_not_of(' ') + 1);
    result.push_back(std::move(text));
  }
  return result;
}

/// How a path is followed: to other files never; `was_asked` becomes true where a file asks for it.
Handle links_in_this_file(bool& was_asked) {
  Handle list(H5Pcreate(H5P_LINK_ACCESS), H5Pclose);
  H5Pset_elink_cb(
      list.id(),
      [](const char*, const char*, const char*, const char*, unsigned*, hid_t, void* asked) -> herr_t {
        *static_cast<bool*>(asked) = true;
        return -1;
      },
      &was_asked);
  return list;
}

/// Why the numbers of a data set are not all in this file, or of a kind that is not read; empty if they are.
std::string why_not_read(hid_t set, hid_t type, hid_t space) {
  const H5T_class_t kind = H5Tget_class(type);
  const int dimensions = H5Sget_simple_extent_ndims(space);
  if (kind != H5T_FLOAT && kind != H5T_INTEGER) return "of something else than numbers";
  if (dimensions < 1 || dimensions > 2) return "of " + std::to_string(dimensions) + " dimensions";
  const Handle list(H5Dget_create_plist(set), H5Pclose);
  if (!list || H5Pget_layout(list.id()) == H5D_VIRTUAL || H5Pget_external_count(list.id()) != 0)
    return "whose numbers are in other files";
  hsize_t size[2]{0, 1};
  H5Sget_simple_extent_dims(space, size, nullptr);
  return size[1] > most_columns ? "of " + std::to_string(size[1]) + " columns" : "";
}

/// A file by its name; bytes in memory as the image of one, which the library copies.
Handle open_source(const Resource& source) {
  if (source.memory() == nullptr) return {H5Fopen(source.name().c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose};
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  constexpr std::size_t growth = 1 << 16;
  H5Pset_fapl_core(access.id(), growth, false);
  std::string& image = const_cast<std::string&>(*source.memory());  // the interface is not const, the library is
  H5Pset_file_image(access.id(), image.data(), image.size());
  return {H5Fopen(source.name().c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose};
}

const char* why_not_open(const Resource& source) {
  static constexpr std::string_view signature("\x89HDF\r\n\x1a\n", 8);
  std::string error;
  const auto bytes = ResourceBytes::open(source, error);
  if (!bytes) return source.exists() ? "it cannot be opened" : "no such file";
  return bytes->view().starts_with(signature) ? "it is damaged or cut short" : "it is no HDF5 file";
}

class Hdf5Reader {
 public:
  Hdf5Reader(const Resource& file, const RunOptions& run, DiagnosticSink& sink)
      : source_(file), name_(file.name().string()), run_(run), sink_(sink), file_(open_source(file)) {
    if (!file_) report(Code::import_unreadable, {name_, why_not_open(file)});
  }

  std::optional<fields::Table> table(const std::string& paths) {
    if (!file_ || !open_all(paths)) return std::nullopt;
    hsize_t columns = 0;
    for (const DataSet& set : sets_) {
      columns += set.columns;
      if (set.rows == sets_[0].rows) continue;
      report(Code::field_file_unsupported, {"'" + set.name + "' with " + std::to_string(set.rows) + " rows beside '" +
                                            sets_[0].name + "' with " + std::to_string(sets_[0].rows)});
      return std::nullopt;
    }
    if (sets_[0].rows == 0 || columns == 0) {
      report(Code::field_file_empty, {"records"});
      return std::nullopt;
    }
    fields::Table result;
    name_columns(result);
    if (auto mapped = map()) {
      result.records = std::move(*mapped);
      return result;
    }
    auto values = room_for(sets_[0].rows, columns);
    if (!values) return std::nullopt;
    hsize_t first = 0;
    for (const DataSet& set : sets_) {
      if (!read(set, H5T_NATIVE_DOUBLE, values->data(), first, columns)) return std::nullopt;
      first += set.columns;
    }
    result.records = std::move(*values).records(sets_[0].rows, columns);
    return result;
  }

  std::optional<std::vector<std::int64_t>> integers(const std::string& path) {
    if (!file_ || !open_all(path)) return std::nullopt;
    const DataSet& set = sets_[0];
    if (sets_.size() != 1 || H5Tget_class(set.type.id()) != H5T_INTEGER) {
      report(Code::field_file_unsupported, {"'" + path + "' in place of one data set of integers"});
      return std::nullopt;
    }
    std::vector<std::int64_t> values;
    if (!allocate(values, set.rows, set.columns) || !read(set, H5T_NATIVE_INT64, values.data(), 0, set.columns))
      return std::nullopt;
    return values;
  }

 private:
  void report(Code code, std::vector<std::string> args) {
    const bool has_place = code != Code::import_unreadable;
    sink_.report({.code = code, .where = {.file = has_place ? name_ : ""}, .args = std::move(args)});
  }

  void report_memory() {
    sink_.report({.code = Code::limit_memory, .args = {std::to_string(run_.max_memory_bytes >> 20) + " MiB"}});
  }
  bool allocate(std::vector<std::int64_t>& values, hsize_t rows, hsize_t columns) {
    hsize_t count = 0;  // extents are what the file states, whatever it holds
    if (__builtin_mul_overflow(rows, columns, &count) || count > run_.max_memory_bytes / sizeof(std::int64_t)) {
      report_memory();
      return false;
    }
    values.resize(count);
    return true;
  }
  /// Many numbers go to a file, unless they cannot have come out of what the data sets hold.
  std::optional<fields::NumberBlock> room_for(hsize_t rows, hsize_t columns) {
    hsize_t count = 0, held = 0;
    for (const DataSet& set : sets_) held += H5Dget_storage_size(set.set.id());
    if (__builtin_mul_overflow(rows, columns, &count) || count >> 60 != 0 ||
        (!fields::NumberBlock::is_in_memory(count, run_) && count * sizeof(double) / most_unpacked > held)) {
      report_memory();
      return std::nullopt;
    }
    return fields::NumberBlock::make(count, run_, sink_);
  }

  bool open_all(const std::string& paths) {
    for (std::size_t at = 0; at <= paths.size();) {
      const std::size_t end = std::min(paths.find(',', at), paths.size());
      if (!open(paths.substr(at, end - at))) return false;
      at = end + 1;
    }
    if (!sets_.empty()) return true;
    report(Code::field_file_empty, {"data set '" + paths + "'"});
    return false;
  }
  Handle object(const std::string& path) {
    return {H5Oopen(file_.id(), path.empty() ? "/" : path.c_str(), links_.id()), H5Oclose};
  }
  bool no_object(const std::string& path) {
    if (leads_out_)
      report(Code::field_file_unsupported, {"the link '" + path + "' to another file"});
    else
      report(Code::field_file_empty, {"data set '" + path + "'"});
    return false;
  }
  bool open(const std::string& path) {
    Handle found = object(path);
    if (!found) return no_object(path);
    if (H5Iget_type(found.id()) == H5I_DATASET) return add(path, std::move(found));
    is_group_ = true;
    std::vector<std::string> names;
    H5Literate(
        found.id(), H5_INDEX_NAME, H5_ITER_INC, nullptr,
        [](hid_t, const char* name, const H5L_info_t*, void* all) -> herr_t {
          static_cast<std::vector<std::string>*>(all)->emplace_back(name);
          return 0;
        },
        &names);
    for (const std::string& name : names) {
      const std::string inner = (path == "/" || path.empty() ? "" : path) + "/" + name;
      Handle one = object(inner);
      if (leads_out_) return no_object(inner);
      if (one && H5Iget_type(one.id()) == H5I_DATASET && !add(inner, std::move(one))) return false;
    }
    return true;
  }
  bool add(const std::string& path, Handle set) {
    Handle type(H5Dget_type(set.id()), H5Tclose);
    const Handle space(H5Dget_space(set.id()), H5Sclose);
    if (const std::string why = why_not_read(set.id(), type.id(), space.id()); !why.empty()) {
      report(Code::field_file_unsupported, {"the data set '" + path + "' " + why});
      return false;
    }
    hsize_t size[2]{0, 1};
    H5Sget_simple_extent_dims(space.id(), size, nullptr);
    std::optional<Texts> texts[2];
    const char* const attributes[]{"components", H5Aexists(set.id(), "unit") > 0 ? "unit" : "units"};
    for (std::size_t i = 0; i < 2; ++i) {
      texts[i] = texts_of(set.id(), attributes[i]);
      if (texts[i]) continue;
      report(Code::field_file_truncated,
             {std::string("in the attribute '") + attributes[i] + "' of '" + path + "', or it is damaged there"});
      return false;
    }
    sets_.push_back(
        {path, std::move(set), std::move(type), size[0], size[1], std::move(*texts[0]), std::move(*texts[1])});
    return true;
  }

  /// names where every data set has them, or where they come from a group.
  void name_columns(fields::Table& table) const {
    const bool all_named =
        std::all_of(sets_.begin(), sets_.end(), [](const DataSet& s) { return s.components.size() == s.columns; });
    if (!all_named && !is_group_) return;
    for (const DataSet& set : sets_) {
      const std::string own = fields::column_name(set.name.substr(set.name.rfind('/') + 1));
      for (std::size_t c = 0; c < set.columns; ++c) {
        const std::string unit = set.units.size() == set.columns ? set.units[c]
                                 : set.units.size() == 1         ? set.units[0]
                                                                 : "";
        table.columns.push_back({set.components.size() == set.columns ? fields::column_name(set.components[c])
                                 : set.columns == 1                   ? own
                                                                      : own + "_" + std::to_string(c + 1),
                                 unit});
      }
    }
  }

  /// One data set of doubles in one piece needs no reading.
  std::optional<fields::Records> map() const {
    if (sets_.size() != 1 || H5Tequal(sets_[0].type.id(), H5T_IEEE_F64LE) <= 0) return std::nullopt;
    const haddr_t offset = H5Dget_offset(sets_[0].set.id());
    if (offset == HADDR_UNDEF) return std::nullopt;
    std::string error;
    auto file = ResourceBytes::open(source_, error);
    if (!file) return std::nullopt;
    return fields::Records::map(std::move(file),
                                {.offset = offset, .rows = sets_[0].rows, .columns = sets_[0].columns});
  }

  /// Into columns `first` ... of rows of `width` numbers, in blocks of rows.
  bool read(const DataSet& set, hid_t number, void* values, hsize_t first, hsize_t width) {
    const Handle file_space(H5Dget_space(set.set.id()), H5Sclose);
    const hsize_t extent[2]{set.rows, width};
    const Handle memory_space(H5Screate_simple(2, extent, nullptr), H5Sclose);
    const hsize_t step = std::max<hsize_t>(1, block_of(set));
    for (hsize_t row = 0; row < set.rows; row += step) {
      if (run_.should_stop()) {
        sink_.report({.code = run_.out_of_time() ? Code::limit_time : Code::cancelled});
        return false;
      }
      const hsize_t rows = std::min(step, set.rows - row);
      const hsize_t from[2]{row, 0}, into[2]{row, first}, count[2]{rows, set.columns};
      H5Sselect_hyperslab(file_space.id(), H5S_SELECT_SET, from, nullptr, count, nullptr);
      H5Sselect_hyperslab(memory_space.id(), H5S_SELECT_SET, into, nullptr, count, nullptr);
      if (H5Dread(set.set.id(), number, memory_space.id(), file_space.id(), H5P_DEFAULT, values) >= 0) continue;
      report(Code::field_file_truncated, {"in the data set '" + set.name + "', or it is damaged there"});
      return false;
    }
    return true;
  }
  /// Whole chunks, so that none is unpacked twice.
  static hsize_t block_of(const DataSet& set) {
    const Handle list(H5Dget_create_plist(set.set.id()), H5Pclose);
    const hsize_t rows = block_values / std::max<hsize_t>(1, set.columns);
    hsize_t chunk[2]{1, 1};
    if (H5Pget_layout(list.id()) != H5D_CHUNKED || H5Pget_chunk(list.id(), 2, chunk) < 1 || chunk[0] == 0) return rows;
    return (rows + chunk[0] - 1) / chunk[0] * chunk[0];
  }

  Resource source_;
  std::string name_;
  const RunOptions& run_;
  DiagnosticSink& sink_;
  Handle file_;
  bool leads_out_ = false;
  Handle links_ = links_in_this_file(leads_out_);
  std::vector<DataSet> sets_;
  bool is_group_ = false;
};

}  // namespace

std::optional<fields::Table> read_field_hdf5(const Resource& file, const std::string& path, const RunOptions& run,
                                             DiagnosticSink& sink) {
  const hdf5::Session session;
  return Hdf5Reader(file, run, sink).table(path);
}

std::optional<std::vector<std::int64_t>> read_field_hdf5_integers(const Resource& file, const std::string& path,
                                                                  const RunOptions& run, DiagnosticSink& sink) {
  const hdf5::Session session;
  return Hdf5Reader(file, run, sink).integers(path);
}

}  // namespace meso
