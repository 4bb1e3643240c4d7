// SPDX-License-Identifier: Apache-2.0
#include "wall.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>

#include "meso/base/unfinished_files.hpp"
#include "stop.hpp"

namespace meso::cli {
namespace {

int to_wall = -1;  ///< of the working process
// What the working process says: a sign, a path, a zero byte.
constexpr char begun = '+', ended = '-', answered = '=';

void say(char sign, std::string_view path) {
  const int error = errno;  // that of what is told
  std::string message(1, sign);
  message += path;
  message += '\0';
  (void)!::write(to_wall, message.data(), message.size());
  errno = error;
}

class Wall {
 public:
  Wall(pid_t worker, int messages, int signals, bool in_json)
      : worker_(worker), messages_(messages), signals_(signals), in_json_(in_json) {}

  [[noreturn]] void wait() {
    for (;;) {
      std::array<pollfd, 2> ready{{{signals_, POLLIN, 0}, {messages_, POLLIN, 0}}};
      if (::poll(ready.data(), ready.size(), -1) < 0 && errno != EINTR) ::_exit(info(Code::internal).exit_code);
      if ((ready[1].revents & POLLIN) != 0) listen();
      // Its end closes the pipe, which would be ready for ever.
      if ((ready[1].revents & (POLLHUP | POLLIN)) == POLLHUP) messages_ = -1;
      if ((ready[0].revents & POLLIN) != 0) take_signal();
      int status = 0;
      if (::waitpid(worker_, &status, WNOHANG) == worker_) end(status);
    }
  }

 private:
  /// What it said so far.
  void listen() {
    std::array<char, 4096> text;
    for (ssize_t size = 0; (size = ::read(messages_, text.data(), text.size())) > 0;)
      heard_.append(text.data(), static_cast<std::size_t>(size));
    std::size_t at = 0;
    for (std::size_t zero = 0; (zero = heard_.find('\0', at)) != std::string::npos; at = zero + 1) {
      const std::string path = heard_.substr(at + 1, zero - at - 1);
      if (heard_[at] == begun) unfinished_.insert(path);
      if (heard_[at] == ended) unfinished_.erase(path);
      if (heard_[at] == answered) is_answered_ = true;
    }
    heard_.erase(0, at);
  }

  void take_signal() {
    signalfd_siginfo got{};
    if (::read(signals_, &got, sizeof got) != sizeof got || got.ssi_signo == SIGCHLD) return;
    // What a terminal sends, it sends to both of us.
    if (got.ssi_code != SI_KERNEL) ::kill(worker_, static_cast<int>(got.ssi_signo));
    is_stopped_ = true;
  }

  [[nodiscard]] Diagnostic why_of(int signal) const {
    if (is_stopped_) return {.code = Code::cancelled};
    if (signal == SIGXCPU) return {.code = Code::limit_time};
    if (signal == SIGKILL) return {.code = Code::limit_memory, .args = {"this machine has"}};
    return {.code = Code::geometry_crashed, .args = {strsignal(signal)}};
  }

  [[noreturn]] void end(int status) {
    listen();
    if (WIFEXITED(status)) ::_exit(WEXITSTATUS(status));
    for (const std::string& path : unfinished_) {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }
    const Diagnostic why = why_of(WTERMSIG(status));
    tell_last(why, in_json_ && !is_answered_);
    ::_exit(info(why.code).exit_code);
  }

  pid_t worker_;
  int messages_;
  int signals_;
  bool in_json_;
  std::string heard_;
  std::set<std::string> unfinished_;
  bool is_stopped_ = false, is_answered_ = false;
};

}  // namespace

void stand_behind_wall(bool in_json) {
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC | O_NONBLOCK) != 0) return;
  sigset_t watched = stop_signals(), before;
  sigaddset(&watched, SIGCHLD);
  sigprocmask(SIG_BLOCK, &watched, &before);
  const pid_t waiting = ::getpid();
  const pid_t worker = ::fork();
  if (worker > 0) {
    ::close(pipe[1]);
    const int signals = ::signalfd(-1, &watched, SFD_CLOEXEC | SFD_NONBLOCK);
    Wall(worker, pipe[0], signals, in_json).wait();
  }
  sigprocmask(SIG_SETMASK, &before, nullptr);
  ::close(pipe[0]);
  if (worker < 0) return;  // one process has to do
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != waiting) ::raise(SIGTERM);  // it ended meanwhile
  to_wall = pipe[1];
  watch_unfinished([](bool is_begun, const std::string& path) { say(is_begun ? begun : ended, path); });
}

void tell_wall_answered() {
  if (to_wall >= 0) say(answered, "");
}

}  // namespace meso::cli
