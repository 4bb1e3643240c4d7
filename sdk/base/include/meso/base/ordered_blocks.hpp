// SPDX-License-Identifier: Apache-2.0
#pragma once
// A file in blocks that several threads make at once and that are written one after the other.
//
//   const WrittenBlocks done = write_in_order(blocks, jobs, sink, [&](std::size_t block, ByteBuffer& out) { ... });
//
// The bytes do not depend on the number of threads. Each thread holds one block, so memory is `jobs` blocks. Once the
// sink has failed no further block is made. What `make` or the sink throws is thrown again here.

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>

#include "meso/base/byte_buffer.hpp"
#include "meso/base/byte_sink.hpp"
#include "meso/base/threads.hpp"

namespace meso {

/// 0 jobs are one for each core.
[[nodiscard]] inline unsigned threads_for(unsigned jobs) {
  return jobs > 0 ? jobs : std::max(1u, std::thread::hardware_concurrency());
}

/// work(block, thread) for all blocks, each once, in any order. What it throws is thrown again here.
template <typename Work>
void for_each_block(std::size_t blocks, std::size_t threads, const Work& work) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr thrown;
  std::mutex mutex;
  on_threads(std::min(threads, blocks), [&](std::size_t thread) {
    try {
      for (std::size_t block = next++; block < blocks; block = next++) work(block, thread);
    } catch (...) {
      next = blocks;
      const std::lock_guard lock(mutex);
      if (!thrown) thrown = std::current_exception();
    }
  });
  if (thrown) std::rethrow_exception(thrown);
}

struct WrittenBlocks {
  std::uint64_t bytes = 0;
  bool complete = true;
};

template <typename Make>
[[nodiscard]] WrittenBlocks write_in_order(std::size_t blocks, unsigned jobs, ByteSink& sink, const Make& make) {
  WrittenBlocks done;
  std::size_t turn = 0;  // the block that is to be written next
  bool is_over = false;
  std::mutex mutex;
  std::condition_variable turned;
  const std::size_t threads = std::min<std::size_t>(threads_for(jobs), blocks);
  std::vector<ByteBuffer> buffers(threads);
  // Blocks are taken in order: the one to be written next is always with a thread that does not wait.
  for_each_block(blocks, threads, [&](std::size_t block, std::size_t thread) {
    ByteBuffer& buffer = buffers[thread];
    try {
      buffer.clear();
      std::unique_lock lock(mutex);
      if (is_over) return;
      lock.unlock();
      make(block, buffer);
      lock.lock();
      turned.wait(lock, [&] { return turn == block || is_over; });
      if (is_over) return;
      done.complete = sink.write(buffer.view());
      done.bytes += buffer.size();
      is_over = !done.complete;
      ++turn;
      turned.notify_all();
    } catch (...) {
      const std::lock_guard lock(mutex);
      is_over = true;
      turned.notify_all();
      throw;
    }
  });
  return done;
}

}  // namespace meso
