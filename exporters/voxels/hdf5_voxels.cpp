// SPDX-License-Identifier: Apache-2.0
#include "meso/export_voxels/hdf5_voxels.hpp"

#include <array>
#include <type_traits>
#include <utility>

#include "meso/hdf5/handle.hpp"

namespace meso {
namespace {

static_assert(std::is_same_v<hid_t, std::int64_t>);

using hdf5::Handle;
using hdf5::Session;

bool write_vector(hid_t dataset, const char* name, const Vec3& v) {
  const std::array<double, 3> values{v.x, v.y, v.z};
  const hsize_t three = 3;
  const Handle space(H5Screate_simple(1, &three, nullptr), H5Sclose);
  const Handle attribute(H5Acreate2(dataset, name, H5T_IEEE_F64LE, space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  return attribute && H5Awrite(attribute.id(), H5T_NATIVE_DOUBLE, values.data()) >= 0;
}

}  // namespace

Hdf5Voxels::~Hdf5Voxels() {
  const Session session;
  close();
}

void Hdf5Voxels::close() {
  if (dataset_ >= 0) H5Dclose(std::exchange(dataset_, -1));
  if (file_ >= 0) H5Fclose(std::exchange(file_, -1));
}

bool Hdf5Voxels::begin(const VoxelArray& array) {
  const Session session;
  array_ = array;
  file_ = H5Fcreate(path_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  if (file_ < 0) return false;
  const std::array<hsize_t, 3> size{array.cells[2], array.cells[1], array.cells[0]}, chunk{1, size[1], size[2]};
  const Handle space(H5Screate_simple(3, size.data(), nullptr), H5Sclose);
  const Handle options(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  if (!space || H5Pset_obj_track_times(options.id(), false) < 0 || H5Pset_chunk(options.id(), 3, chunk.data()) < 0 ||
      H5Pset_shuffle(options.id()) < 0 || H5Pset_deflate(options.id(), 4) < 0)
    return false;
  dataset_ =
      H5Dcreate2(file_, std::string(array.name).c_str(), array.type == VoxelType::uint8 ? H5T_STD_U8LE : H5T_IEEE_F32LE,
                 space.id(), H5P_DEFAULT, options.id(), H5P_DEFAULT);
  return dataset_ >= 0 && write_vector(dataset_, "origin_mm", array.origin) &&
         write_vector(dataset_, "spacing_mm", array.spacing);
}

bool Hdf5Voxels::write_plane(std::string_view bytes) {
  const Session session;
  const std::array<hsize_t, 3> start{plane_++, 0, 0}, count{1, array_.cells[1], array_.cells[0]};
  const Handle all(H5Dget_space(dataset_), H5Sclose), plane(H5Screate_simple(3, count.data(), nullptr), H5Sclose);
  return H5Sselect_hyperslab(all.id(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) >= 0 &&
         H5Dwrite(dataset_, array_.type == VoxelType::uint8 ? H5T_NATIVE_UINT8 : H5T_NATIVE_FLOAT, plane.id(), all.id(),
                  H5P_DEFAULT, bytes.data()) >= 0;
}

bool Hdf5Voxels::finish() {
  const Session session;
  const bool flushed = H5Fflush(file_, H5F_SCOPE_LOCAL) >= 0;
  close();
  return flushed;
}

}  // namespace meso
