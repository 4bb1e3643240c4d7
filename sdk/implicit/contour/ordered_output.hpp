// SPDX-License-Identifier: Apache-2.0
#pragma once
// Bricks finish in any order; their bytes leave in the order of the bricks.
//
// The thread whose brick is next writes as it goes, from a buffer that stays in cache. Others gather their bytes; who
// finishes early leaves them behind and starts another brick, and the thread that reaches them writes them. Who has
// gathered more than a brick may hold waits for its turn.

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string_view>
#include <vector>

#include "meso/base/byte_buffer.hpp"

namespace meso::implicit {

class OrderedOutput {
 public:
  /// `write` is called by one thread at a time; after it has returned false it is not called again.
  OrderedOutput(std::function<bool(std::string_view)> write, std::size_t max_waiting, std::uint64_t max_held_bytes)
      : write_(std::move(write)), max_waiting_(max_waiting), max_held_bytes_(max_held_bytes) {}

  /// A buffer for a new brick, once not too many finished ones wait. Call before the brick is chosen.
  [[nodiscard]] ByteBuffer acquire();
  /// Writes what there is if the brick is next, and waits for that if it is too much to hold; to be called now and
  /// then.
  void offer(std::size_t brick, ByteBuffer& bytes);
  void finish(std::size_t brick, ByteBuffer bytes);
  /// Nothing more will be written: nobody waits.
  void stop();

  [[nodiscard]] bool failed() const;

 private:
  static constexpr std::size_t worth_writing = std::size_t{1} << 18;

  void put(ByteBuffer& bytes);  // by the thread of the next brick only

  std::function<bool(std::string_view)> write_;
  std::size_t max_waiting_;
  std::uint64_t max_held_bytes_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t next_ = 0;
  std::map<std::size_t, ByteBuffer> waiting_;
  std::vector<ByteBuffer> free_;
  bool failed_ = false, stopped_ = false;
};

}  // namespace meso::implicit
