// SPDX-License-Identifier: Apache-2.0
#include "stop.hpp"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <thread>
#include <vector>

namespace meso::cli {
namespace {

std::atomic<bool> stop{false};
std::atomic<std::int64_t> deadline_ns{0};  // steady clock; 0: none

using Clock = std::chrono::steady_clock;
namespace fs = std::filesystem;

std::mutex folders_mutex;
std::vector<fs::path> folders;

// OutputFile names its temporaries .<target>.<process id>-<counter>.tmp
void remove_unfinished_files() {
  const std::lock_guard lock(folders_mutex);
  const std::string mark = "." + std::to_string(::getpid()) + "-";
  for (const fs::path& folder : folders) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      const std::string name = entry.path().filename().string();
      if (name.starts_with('.') && name.ends_with(".tmp") && name.find(mark) != std::string::npos)
        fs::remove(entry.path(), error);
    }
  }
}

[[noreturn]] void end_now(const char* text, int exit_code) {
  remove_unfinished_files();
  std::fputs(text, stderr);
  std::fflush(stderr);
  ::_exit(exit_code);
}

sigset_t stop_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  return set;
}

void wait_for_signals() {
  const sigset_t set = stop_signals();
  Clock::time_point asked{};
  for (;;) {
    const timespec slice{0, 100'000'000};
    if (sigtimedwait(&set, nullptr, &slice) > 0) {
      if (stop) end_now("\nerror CANCELLED: stopped by the user; nothing was written\n", 130);
      stop = true;
      asked = Clock::now();
    }
    const auto now = Clock::now();
    // OpenCASCADE polls only between faces: the work gets a moment to unwind, then the process goes.
    if (stop && now - asked > std::chrono::milliseconds(800)) {
      end_now("error CANCELLED: stopped by the user; nothing was written\n", 130);
    }
    const std::int64_t limit = deadline_ns;
    if (limit != 0 && now.time_since_epoch().count() > limit) {
      end_now("error LIMIT_TIME: the time given by --timeout is over; nothing was written\n", 6);
    }
  }
}

}  // namespace

void watch_stop_signals() {
  const sigset_t set = stop_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  std::thread(wait_for_signals).detach();
}

bool stop_requested() { return stop; }

void clean_on_stop(const fs::path& output) {
  const std::lock_guard lock(folders_mutex);
  folders.push_back(output.has_parent_path() ? output.parent_path() : fs::path("."));
}

void end_after(double seconds) {
  const auto limit =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds + 1));
  deadline_ns = limit.time_since_epoch().count();
}

}  // namespace meso::cli
