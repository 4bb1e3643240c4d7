// SPDX-License-Identifier: Apache-2.0
#pragma once
// Bytes that are appended at high speed and thrown away together: room first, then what was used of it.
//
//   char* to = buffer.claim(12);   // room for 12 bytes at the end
//   buffer.advance(12);            // all of them were written
//
// Grows by doubling and never shrinks, so that a reused buffer stops allocating. Thread rule: one thread.

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <memory>
#include <string_view>

namespace meso {

class ByteBuffer {
 public:
  /// Valid until the next claim().
  [[nodiscard]] char* claim(std::size_t bytes) {
    if (capacity_ - size_ < bytes) grow(bytes);
    return data_.get() + size_;
  }
  void advance(std::size_t bytes) { size_ += bytes; }
  void append(std::string_view text) {
    if (text.empty()) return;
    std::memcpy(claim(text.size()), text.data(), text.size());
    advance(text.size());
  }
  void clear() { size_ = 0; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::string_view view() const { return {data_.get(), size_}; }

 private:
  void grow(std::size_t bytes) {
    capacity_ = std::max({2 * capacity_, size_ + bytes, std::size_t{1} << 16});
    std::unique_ptr<char[]> larger(new char[capacity_]);  // make_unique would clear it
    if (size_ > 0) std::memcpy(larger.get(), data_.get(), size_);
    data_ = std::move(larger);
  }

  std::unique_ptr<char[]> data_;
  std::size_t size_ = 0, capacity_ = 0;
};

}  // namespace meso
