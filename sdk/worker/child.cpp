// SPDX-License-Identifier: Apache-2.0
#include "child.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <optional>

namespace meso::worker {
namespace {

constexpr int asked_every_ms = 100;
constexpr std::chrono::seconds to_end(3);

/// Closes itself.
struct Pipe {
  std::array<int, 2> ends{-1, -1};
  bool is_open = ::pipe2(ends.data(), O_CLOEXEC) == 0;

  Pipe() = default;
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    close(0);
    close(1);
  }
  void close(std::size_t end) {
    if (ends[end] >= 0) ::close(ends[end]);
    ends[end] = -1;
  }
  /// False at its end.
  bool read_into(std::string& text) {
    std::array<char, 65536> block;
    const ssize_t size = ::read(ends[0], block.data(), block.size());
    if (size > 0) text.append(block.data(), static_cast<std::size_t>(size));
    if (size == 0 || (size < 0 && errno != EINTR)) close(0);
    return ends[0] >= 0;
  }
};

/// Its own group of processes, no signal blocked or ignored, whatever the host does with signals.
int start(const std::vector<std::string>& words, int out, int error, pid_t& child) {
  posix_spawn_file_actions_t files;
  posix_spawnattr_t how;
  posix_spawn_file_actions_init(&files);
  posix_spawnattr_init(&how);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&files, out, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, error, STDERR_FILENO);
  sigset_t none, all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&how, &none);
  posix_spawnattr_setsigdefault(&how, &all);
  posix_spawnattr_setpgroup(&how, 0);
  posix_spawnattr_setflags(&how, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const int failed = ::posix_spawnp(&child, arguments[0], &files, &how, arguments.data(), environ);
  posix_spawnattr_destroy(&how);
  posix_spawn_file_actions_destroy(&files);
  return failed;
}

void take_lines(std::string& text, const std::function<void(std::string_view)>& hear_line) {
  std::size_t at = 0;
  for (std::size_t line = 0; (line = text.find('\n', at)) != std::string::npos; at = line + 1)
    hear_line(std::string_view(text).substr(at, line - at));
  text.erase(0, at);
}

}  // namespace

ChildEnd run_child(const std::vector<std::string>& words, const std::function<void(std::string_view)>& hear_line,
                   const std::function<bool()>& should_stop) {
  ChildEnd end;
  Pipe out, error;
  if (!out.is_open || !error.is_open) return end.start_error = errno, end;
  pid_t child = 0;
  end.start_error = start(words, out.ends[1], error.ends[1], child);
  out.close(1);
  error.close(1);
  if (end.start_error != 0) return end;
  std::string heard;
  std::optional<std::chrono::steady_clock::time_point> asked;
  bool is_hearing = true;
  for (bool is_killed = false; !is_killed && is_hearing;) {
    std::array<pollfd, 2> ready{{{out.ends[0], POLLIN, 0}, {error.ends[0], POLLIN, 0}}};
    (void)::poll(ready.data(), ready.size(), asked_every_ms);
    if (ready[0].revents != 0) out.read_into(end.output);
    if (ready[1].revents != 0 && (error.read_into(heard), true)) take_lines(heard, hear_line);
    is_hearing = out.ends[0] >= 0 || error.ends[0] >= 0;
    const auto now = std::chrono::steady_clock::now();
    if (!asked && should_stop()) {
      asked = now;
      ::kill(child, SIGTERM);
    }
    is_killed = asked && now - *asked > to_end;
    if (is_killed) ::kill(-child, SIGKILL);
  }
  while (::waitpid(child, &end.status, 0) < 0 && errno == EINTR) {
  }
  return end;
}

}  // namespace meso::worker
