// SPDX-License-Identifier: Apache-2.0
#include "stop.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <chrono>
#include <climits>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <new>
#include <string_view>
#include <thread>

#include "meso/base/unfinished_files.hpp"
#include "run.hpp"

namespace meso::cli {
namespace {

enum class Speaker { nobody, work, watch };

std::atomic<bool> stop{false};
std::atomic<bool> in_json{false};
std::atomic<Speaker> speaker{Speaker::nobody};
std::atomic<std::int64_t> deadline_ns{0};  // steady clock; 0: none
std::atomic<std::uint64_t> most_bytes{0};  // 0: any number
std::atomic<bool> out_of_memory{false};
std::string most_bytes_text;  // set before most_bytes is

using Clock = std::chrono::steady_clock;

bool speaks(Speaker who) {
  Speaker expected = Speaker::nobody;
  return speaker.compare_exchange_strong(expected, who);
}

/// What a reader takes at once: a pipe that is full must not keep the process, nor a lock that stdio holds. A pipe that
/// is ready takes PIPE_BUF bytes.
void write_if_ready(int file, std::string_view text) {
  pollfd ready{.fd = file, .events = POLLOUT, .revents = 0};
  if (::poll(&ready, 1, 0) == 1 && ready.revents == POLLOUT)
    (void)!::write(file, text.data(), std::min<std::size_t>(text.size(), PIPE_BUF));
}

[[noreturn]] void end_now(Code code) {
  try {
    const bool is_told = !speaks(Speaker::watch);
    remove_unfinished();
    if (!is_told)
      tell_last(code == Code::limit_memory ? memory_ended(most_bytes_text) : Diagnostic{.code = code}, in_json);
  } catch (...) {  // no memory is left to say why
  }
  ::_exit(info(code).exit_code);
}

/// As end_now(), but an answer that is being given has another second: it may wait for its reader for ever.
void end_unless_answering(Code code, Clock::duration late) {
  if (speaker != Speaker::work || late > std::chrono::seconds(1)) end_now(code);
}

/// What RLIMIT_DATA counts: private writable memory. Allocates nothing.
std::uint64_t data_bytes() {
  std::array<char, 256> text{};
  const int file = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  const ssize_t size = file < 0 ? 0 : ::read(file, text.data(), text.size());
  if (file >= 0) ::close(file);
  const char* const end = text.data() + std::max<ssize_t>(size, 0);
  const char* next = text.data();
  std::uint64_t pages = 0;
  constexpr int fields_before = 5;
  for (int field = 0; field <= fields_before; ++field) {
    const auto [rest, error] = std::from_chars(next, end, pages);
    if (error != std::errc()) return 0;
    next = rest < end ? rest + 1 : end;
  }
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

void wait_for_signals(sigset_t set) {
  // OpenCASCADE polls only between faces: the work gets a moment to unwind, then the process goes.
  constexpr std::chrono::milliseconds to_unwind(600);
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
    if (stop && now - asked > to_unwind)
      end_unless_answering(out_of_memory ? Code::limit_memory : Code::cancelled, now - asked - to_unwind);
    const std::int64_t limit = deadline_ns;
    if (const Clock::duration late(now.time_since_epoch().count() - limit); limit != 0 && late.count() > 0)
      end_unless_answering(Code::limit_time, late);
  }
}

}  // namespace

sigset_t stop_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction inherited {};
    if (sigaction(number, nullptr, &inherited) == 0 && inherited.sa_handler != SIG_IGN) sigaddset(&set, number);
  }
  return set;
}

void tell_last(const Diagnostic& why, bool as_json) {
  if (as_json) {
    DiagnosticSink sink;
    sink.report(why);
    write_if_ready(STDOUT_FILENO,
                   Json{{"error", error_json(why)}, {"diagnostics", diagnostics_json(sink)}}.dump(2) + "\n");
  }
  write_if_ready(STDERR_FILENO, "\n" + render(why) + "\n");
}

void watch_stop_signals() {
  // Memory may end in a thread of a library, where nobody catches it.
  std::set_terminate([] {
    try {
      if (const std::exception_ptr thrown = std::current_exception()) std::rethrow_exception(thrown);
    } catch (const std::bad_alloc&) {
      end_now(Code::limit_memory);
    } catch (...) {
    }
    std::abort();
  });
  const sigset_t set = stop_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond `ulimit -f`: the write fails, and is told as such
  std::thread(wait_for_signals, set).detach();
}

bool stop_requested() { return stop; }

void answer_stop_in_json() { in_json = true; }

bool claim_answer() {
  if (speaks(Speaker::work)) return true;
  while (speaker == Speaker::watch) ::pause();  // the process is about to end
  return false;
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
