#pragma once
// Few of very many cells, by consecutive numbers.

#include <bit>
#include <cstdint>
#include <vector>

namespace impinge {

/// Numbers cells 0, 1, 2, ... in the order in which they come: a hash table with linear probing.
class CellIndex {
 public:
  int size() const { return static_cast<int>(cell_.size()); }

  /// The cell of a number.
  std::int64_t cell(int number) const { return cell_[static_cast<std::size_t>(number)]; }

  /// Number of a cell, or -1.
  int find(std::int64_t cell) const { return slot_.empty() ? -1 : slot_[slot_of(cell)]; }

  /// Number of a cell, which is the next one where it has none.
  int insert(std::int64_t cell) {
    if (2 * cell_.size() >= slot_.size()) grow();
    int& number = slot_[slot_of(cell)];
    if (number < 0) {
      number = size();
      cell_.push_back(cell);
    }
    return number;
  }

  void clear() {
    cell_.clear();
    slot_.clear();
  }

  /// Memory [bytes].
  std::size_t bytes() const { return cell_.capacity() * sizeof(std::int64_t) + slot_.capacity() * sizeof(int); }

 private:
  // That of the cell, or the free one where it would be.
  std::size_t slot_of(std::int64_t cell) const {
    constexpr std::uint64_t golden = 0x9e3779b97f4a7c15;  // 2^64 over the golden ratio
    const std::size_t last = slot_.size() - 1;
    auto slot = static_cast<std::size_t>((static_cast<std::uint64_t>(cell) * golden) >> shift_);
    while (slot_[slot] >= 0 && this->cell(slot_[slot]) != cell) slot = (slot + 1) & last;
    return slot;
  }

  void grow() {
    const std::size_t slots = slot_.empty() ? 16 : 2 * slot_.size();
    shift_ = 64 - std::countr_zero(slots);
    slot_.assign(slots, -1);
    for (int number = 0; number < size(); ++number) slot_[slot_of(cell(number))] = number;
  }

  std::vector<std::int64_t> cell_;  // of each number
  std::vector<int> slot_;           // numbers, -1 where none is; a power of two of them
  int shift_ = 64;
};

}  // namespace impinge
