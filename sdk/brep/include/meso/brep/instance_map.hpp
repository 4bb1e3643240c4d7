// SPDX-License-Identifier: Apache-2.0
#pragma once
// A map from (edge or vertex of a template, lattice cell) to a small value: what makes an instance that several faces
// share the same one, in files, audits and shapes.
//
//   InstanceMap<std::uint32_t> ids;
//   auto [id, fresh] = ids.find_or_add(coedge.edge, cell + coedge.offset);
//   if (fresh) id = next_id++;
//
// 8 + sizeof(Value) bytes per slot, at most three quarters of the slots used; one probe or two per look-up. A returned
// reference lives until the next call. Not for sharing between threads.

#include <bit>
#include <cstdint>
#include <utility>
#include <vector>

#include "meso/brep/body.hpp"

namespace meso::brep {

[[nodiscard]] inline Index3 operator+(const Index3& a, const Index3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

/// Open addressing with linear probing; keys are any 64-bit numbers but ~0.
template <typename Value>
class FlatMap {
 public:
  [[nodiscard]] std::pair<Value&, bool> find_or_add(std::uint64_t key) {
    if (4 * (size_ + 1) > 3 * keys_.size()) grow();
    const std::size_t slot = slot_of(key);
    const bool fresh = keys_[slot] == empty_key;
    if (fresh) {
      keys_[slot] = key;
      values_[slot] = Value{};
      ++size_;
    }
    return {values_[slot], fresh};
  }
  /// Null: there is none. May be called by several threads while nobody adds.
  [[nodiscard]] const Value* find(std::uint64_t key) const {
    if (keys_.empty()) return nullptr;
    const std::size_t slot = slot_of(key);
    return keys_[slot] == key ? &values_[slot] : nullptr;
  }
  template <typename Visit>
  void visit_values(Visit visit) const {
    for (std::size_t i = 0; i < keys_.size(); ++i)
      if (keys_[i] != empty_key) visit(values_[i]);
  }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  static constexpr std::uint64_t empty_key = ~std::uint64_t{0};

  [[nodiscard]] std::size_t slot_of(std::uint64_t key) const {
    const std::size_t mask = keys_.size() - 1;
    std::uint64_t h = key * 0x9e3779b97f4a7c15u;  // Fibonacci hashing; the high bits are the mixed ones
    h ^= h >> 32;
    std::size_t slot = h & mask;
    while (keys_[slot] != empty_key && keys_[slot] != key) slot = (slot + 1) & mask;
    return slot;
  }
  void grow() {
    const std::vector<std::uint64_t> keys = std::exchange(keys_, {});
    const std::vector<Value> values = std::exchange(values_, {});
    const std::size_t slots = keys.empty() ? 64 : 2 * keys.size();
    keys_.assign(slots, empty_key);
    values_.resize(slots);
    for (std::size_t i = 0; i < keys.size(); ++i) {
      if (keys[i] == empty_key) continue;
      const std::size_t slot = slot_of(keys[i]);
      keys_[slot] = keys[i];
      values_[slot] = values[i];
    }
  }

  std::vector<std::uint64_t> keys_;
  std::vector<Value> values_;
  std::size_t size_ = 0;
};

/// Numbers cells 0, 1, 2 ... in the order of their first mention. A cell is 96 bits: the two halves are two maps.
class CellNumbers {
 public:
  [[nodiscard]] std::uint32_t operator()(const Index3& cell) {
    if (last_number_ != none && cell == last_cell_) return last_number_;
    const auto [column, new_column] = columns_.find_or_add(column_key(cell));
    if (new_column) column = static_cast<std::uint32_t>(columns_.size());
    const auto [number, new_cell] = cells_.find_or_add(std::uint64_t{column} << 32 | bits(cell[2]));
    if (new_cell) number = static_cast<std::uint32_t>(cells_.size() - 1);
    last_cell_ = cell;
    return last_number_ = number;
  }
  /// Null: not mentioned yet.
  [[nodiscard]] const std::uint32_t* find(const Index3& cell) const {
    const std::uint32_t* column = columns_.find(column_key(cell));
    return column != nullptr ? cells_.find(std::uint64_t{*column} << 32 | bits(cell[2])) : nullptr;
  }

 private:
  static std::uint64_t bits(std::int32_t v) { return std::bit_cast<std::uint32_t>(v); }
  /// Flipping a bit moves the one forbidden key from cell (-1, -1) to (-1, 2^31 - 1), which no lattice reaches.
  static std::uint64_t column_key(const Index3& cell) { return (bits(cell[0]) << 32 | bits(cell[1])) ^ 0x80000000u; }

  static constexpr std::uint32_t none = ~std::uint32_t{0};
  FlatMap<std::uint32_t> columns_, cells_;
  Index3 last_cell_{};
  std::uint32_t last_number_ = none;
};

template <typename Value>
class InstanceMap {
 public:
  [[nodiscard]] std::pair<Value&, bool> find_or_add(std::uint32_t item, const Index3& cell) {
    return map_.find_or_add(std::uint64_t{cells_(cell)} << 32 | item);
  }
  /// Null: there is none. May be called by several threads while nobody adds.
  [[nodiscard]] const Value* find(std::uint32_t item, const Index3& cell) const {
    const std::uint32_t* number = cells_.find(cell);
    return number != nullptr ? map_.find(std::uint64_t{*number} << 32 | item) : nullptr;
  }
  template <typename Visit>
  void visit_values(Visit visit) const {
    map_.visit_values(visit);
  }
  [[nodiscard]] std::size_t size() const { return map_.size(); }

 private:
  CellNumbers cells_;
  FlatMap<Value> map_;
};

}  // namespace meso::brep
