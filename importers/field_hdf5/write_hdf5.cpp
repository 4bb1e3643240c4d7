// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "meso/hdf5/handle.hpp"
#include "meso/import_field_hdf5/read_hdf5.hpp"

namespace meso {
namespace {

using hdf5::Handle;

constexpr std::size_t block_rows = 1 << 16;

bool write_texts(hid_t object, const char* attribute, const std::vector<std::string>& texts) {
  std::size_t longest = 1;
  for (const std::string& text : texts) longest = std::max(longest, text.size());
  std::string bytes;
  for (const std::string& text : texts) bytes += text + std::string(longest - text.size(), '\0');
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.id(), longest);
  H5Tset_strpad(type.id(), H5T_STR_NULLPAD);
  H5Tset_cset(type.id(), H5T_CSET_UTF8);
  const hsize_t count = texts.size();
  const Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  const Handle a(H5Acreate2(object, attribute, type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  return a && H5Awrite(a.id(), type.id(), bytes.data()) >= 0;
}

bool write(const fields::Table& table, const std::string& file) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose), creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_libver_bounds(access.id(), H5F_LIBVER_V18, H5F_LIBVER_LATEST);
  // No times of creation, neither of the data set nor of the root group: equal tables give equal bytes.
  const Handle root(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_obj_track_times(creation.id(), false);
  H5Pset_obj_track_times(root.id(), false);
  const Handle out(H5Fcreate(file.c_str(), H5F_ACC_TRUNC, root.id(), access.id()), H5Fclose);
  if (!out) return false;
  const hsize_t size[]{table.records.rows(), table.records.columns()};
  const Handle space(H5Screate_simple(2, size, nullptr), H5Sclose);
  const Handle set(H5Dcreate2(out.id(), "records", H5T_IEEE_F64LE, space.id(), H5P_DEFAULT, creation.id(), H5P_DEFAULT),
                   H5Dclose);
  if (!set) return false;
  std::vector<std::string> names, units;
  for (const fields::Column& c : table.columns) {
    names.push_back(c.name);
    units.push_back(c.unit);
  }
  if (!names.empty() && (!write_texts(set.id(), "components", names) || !write_texts(set.id(), "unit", units)))
    return false;
  std::vector<double> block;
  for (hsize_t row = 0; row < size[0]; row += block_rows) {
    const hsize_t rows = std::min<hsize_t>(block_rows, size[0] - row);
    block.clear();
    for (hsize_t r = row; r < row + rows; ++r) {
      for (hsize_t c = 0; c < size[1]; ++c) block.push_back(table.records(r, c));
    }
    const hsize_t from[]{row, 0}, count[]{rows, size[1]};
    const Handle memory(H5Screate_simple(2, count, nullptr), H5Sclose);
    H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, from, nullptr, count, nullptr);
    if (H5Dwrite(set.id(), H5T_NATIVE_DOUBLE, memory.id(), space.id(), H5P_DEFAULT, block.data()) < 0) return false;
  }
  return H5Fflush(out.id(), H5F_SCOPE_GLOBAL) >= 0;
}

}  // namespace

bool write_field_hdf5(const fields::Table& table, const std::string& file, DiagnosticSink& sink) {
  const hdf5::Session session;
  if (write(table, file)) return true;
  sink.report({.code = Code::write_failed, .args = {file, "HDF5 cannot write it"}});
  return false;
}

}  // namespace meso
