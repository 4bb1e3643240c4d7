// SPDX-License-Identifier: Apache-2.0
#pragma once
// HDF5 identifiers that close themselves, and the lock that every use of the library needs.
//
//   const hdf5::Session session;   // first, and for as long as anything of the library is in use
//   const hdf5::Handle file(H5Fopen(name, H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
//   if (!file) ...
//
// Thread rule: one Session at a time; a second one waits.

#include <hdf5.h>

#include <mutex>
#include <utility>

namespace meso::hdf5 {

class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  [[nodiscard]] hid_t id() const { return id_; }
  [[nodiscard]] explicit operator bool() const { return id_ >= 0; }

 private:
  hid_t id_;
  Close close_;
};

/// The library has one set of global tables and no lock of its own; it would also print errors that are ours to report,
/// and load code from folders that the environment names.
class Session {
 public:
  Session() : lock_(mutex()) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    H5PLset_loading_state(0);
  }

 private:
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }
  std::lock_guard<std::mutex> lock_;
};

}  // namespace meso::hdf5
