// SPDX-License-Identifier: Apache-2.0
#pragma once
// Temporary files and folders of this process, so that none is left behind where it has to end at once.
//
//   const bool made = make_unfinished(temporary, [&] { return (file = ::open(temporary.c_str(), ...)) >= 0; });
//   const bool published = finish_unfinished(temporary, [&] { return ::rename(temporary.c_str(), target) == 0; });
//
// From remove_unfinished() on nothing is made or published any more: both answer false, with errno ECANCELED, and do
// not call `change`. Thread rule: any thread; one `change` at a time, so it must be short.

#include <functional>
#include <string>

namespace meso {

/// Calls `change`, which makes `path` or something in it, and remembers `path` if that is true. Returns what it says.
[[nodiscard]] bool make_unfinished(const std::string& path, const std::function<bool()>& change);
/// Calls `change`, which renames or removes `path`, and forgets `path` if that is true. Returns what it says.
bool finish_unfinished(const std::string& path, const std::function<bool()>& change);
/// For the end of the process: removes all that is remembered, folders with what they hold.
void remove_unfinished();

/// For another process that cleans up where this one cannot: told of every path before it is made, and after it is
/// finished. Call before there are any.
void watch_unfinished(std::function<void(bool is_begun, const std::string& path)> watcher);

}  // namespace meso
