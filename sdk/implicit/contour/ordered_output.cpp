// SPDX-License-Identifier: Apache-2.0
#include "ordered_output.hpp"

namespace meso::implicit {

ByteBuffer OrderedOutput::acquire() {
  std::unique_lock lock(mutex_);
  // The next brick is always somebody's work, never waiting: so this ends.
  changed_.wait(lock, [&] { return waiting_.size() < max_waiting_ || failed_ || stopped_; });
  if (free_.empty()) return {};
  ByteBuffer bytes = std::move(free_.back());
  free_.pop_back();
  return bytes;
}

void OrderedOutput::offer(std::size_t brick, ByteBuffer& bytes) {
  if (bytes.size() < worth_writing) return;
  {
    std::unique_lock lock(mutex_);
    if (brick != next_ && bytes.size() < max_held_bytes_) return;
    // The thread of the next brick does not wait: so this ends.
    changed_.wait(lock, [&] { return brick == next_ || failed_ || stopped_; });
    if (brick != next_) return;
  }
  put(bytes);
}

void OrderedOutput::put(ByteBuffer& bytes) {
  if (bytes.size() > 0 && !failed() && !write_(bytes.view())) {
    const std::lock_guard lock(mutex_);
    failed_ = true;
  }
  bytes.clear();
}

void OrderedOutput::finish(std::size_t brick, ByteBuffer bytes) {
  std::unique_lock lock(mutex_);
  if (brick != next_) {
    waiting_.emplace(brick, std::move(bytes));
    return;
  }
  while (true) {
    lock.unlock();
    put(bytes);
    lock.lock();
    free_.push_back(std::move(bytes));
    ++next_;
    const auto found = waiting_.find(next_);
    if (found == waiting_.end()) break;
    bytes = std::move(found->second);
    waiting_.erase(found);
  }
  lock.unlock();
  changed_.notify_all();
}

void OrderedOutput::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  changed_.notify_all();
}

bool OrderedOutput::failed() const {
  const std::lock_guard lock(mutex_);
  return failed_;
}

}  // namespace meso::implicit
