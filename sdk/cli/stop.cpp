// SPDX-License-Identifier: Apache-2.0
#include "stop.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <sstream>
#include <thread>
#include <vector>

#include "run.hpp"

namespace meso::cli {
namespace {

std::atomic<bool> stop{false};
std::atomic<bool> in_json{false}, answered{false};
std::atomic<std::int64_t> deadline_ns{0};  // steady clock; 0: none
std::atomic<std::uint64_t> most_bytes{0};  // 0: any number
std::atomic<bool> out_of_memory{false};
std::string most_bytes_text;  // set before most_bytes is

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
        fs::remove_all(entry.path(), error);
    }
  }
}

[[noreturn]] void end_now(Code code) {
  remove_unfinished_files();
  Diagnostic why{.code = code};
  if (code == Code::limit_memory) why.args = {most_bytes_text};
  if (in_json && claim_answer()) {
    std::fputs((Json{{"error", error_json(why)}, {"diagnostics", Json::array()}}.dump(2) + "\n").c_str(), stdout);
    std::fflush(stdout);
  }
  std::fputs(("\n" + render(why) + "\n").c_str(), stderr);
  std::fflush(stderr);
  ::_exit(info(code).exit_code);
}

sigset_t stop_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  sigaddset(&set, SIGHUP);
  return set;
}

/// What RLIMIT_DATA counts: private writable memory.
std::uint64_t data_bytes() {
  std::array<char, 256> text{};
  const int file = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  const ssize_t size = file < 0 ? 0 : ::read(file, text.data(), text.size() - 1);
  if (file >= 0) ::close(file);
  std::istringstream fields(size > 0 ? text.data() : "");
  std::uint64_t pages = 0;
  for (int field = 0; field < 6; ++field) fields >> pages;
  return fields ? pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) : 0;
}

void wait_for_signals() {
  const sigset_t set = stop_signals();
  Clock::time_point asked{};
  for (;;) {
    const timespec slice{0, 20'000'000};
    if (sigtimedwait(&set, nullptr, &slice) > 0) {
      if (stop) end_now(Code::cancelled);
      stop = true;
      asked = Clock::now();
    }
    const auto now = Clock::now();
    if (const std::uint64_t most = most_bytes; most > 0 && !stop && data_bytes() > most) {
      out_of_memory = true;
      stop = true;
      asked = now;
    }
    // OpenCASCADE polls only between faces: the work gets a moment to unwind, then the process goes.
    if (stop && now - asked > std::chrono::milliseconds(600)) {
      end_now(out_of_memory ? Code::limit_memory : Code::cancelled);
    }
    const std::int64_t limit = deadline_ns;
    if (limit != 0 && now.time_since_epoch().count() > limit) {
      end_now(Code::limit_time);
    }
  }
}

}  // namespace

void watch_stop_signals() {
  const sigset_t set = stop_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond `ulimit -f`: the write fails, and is told as such
  std::thread(wait_for_signals).detach();
}

bool stop_requested() { return stop; }

void answer_stop_in_json() { in_json = true; }

bool claim_answer() { return !answered.exchange(true); }

void clean_on_stop(const fs::path& output) {
  const std::lock_guard lock(folders_mutex);
  folders.push_back(output.has_parent_path() ? output.parent_path() : fs::path("."));
}

void end_beyond(std::uint64_t bytes, std::string text) {
  most_bytes_text = std::move(text);
  most_bytes = bytes;
}

bool memory_ran_out() { return out_of_memory; }

void end_after(double seconds) {
  const auto limit =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds + 1));
  deadline_ns = limit.time_since_epoch().count();
}

}  // namespace meso::cli
