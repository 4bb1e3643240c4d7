// SPDX-License-Identifier: Apache-2.0
#include "meso/base/unfinished_files.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <mutex>
#include <vector>

namespace meso {
namespace {

struct Unfinished {
  std::mutex mutex;
  std::vector<std::string> paths;
  std::function<void(bool is_begun, const std::string& path)> watcher = [](bool, const std::string&) {};
  bool is_over = false;
};

// Never destroyed: a thread that ends the process may ask while static objects are.
Unfinished& unfinished() {
  static auto* const all = new Unfinished;
  return *all;
}

}  // namespace

bool make_unfinished(const std::string& path, const std::function<bool()>& change) {
  Unfinished& all = unfinished();
  const std::lock_guard lock(all.mutex);
  if (all.is_over) return errno = ECANCELED, false;
  const bool is_new = std::ranges::find(all.paths, path) == all.paths.end();
  if (is_new) {  // before there is anything: this may throw
    all.paths.push_back(path);
    all.watcher(true, path);
  }
  const bool made = change();
  if (!made && is_new) {
    all.paths.pop_back();
    all.watcher(false, path);
  }
  return made;
}

bool finish_unfinished(const std::string& path, const std::function<bool()>& change) {
  Unfinished& all = unfinished();
  const std::lock_guard lock(all.mutex);
  if (all.is_over) return errno = ECANCELED, false;
  if (!change()) return false;
  std::erase(all.paths, path);
  all.watcher(false, path);
  return true;
}

void remove_unfinished() {
  Unfinished& all = unfinished();
  const std::lock_guard lock(all.mutex);
  all.is_over = true;
  // Memory may have run out, and unlink() needs none.
  for (const std::string& path : all.paths) {
    std::error_code ignored;
    if (::unlink(path.c_str()) != 0 && errno == EISDIR) std::filesystem::remove_all(path, ignored);
  }
}

void watch_unfinished(std::function<void(bool is_begun, const std::string& path)> watcher) {
  unfinished().watcher = std::move(watcher);
}

}  // namespace meso
