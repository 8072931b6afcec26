#pragma once
// Keeps the deflections of the stamps that were cut last. Whoever reads a surface that a deflected cutter left needs
// the deflection of that very stamp.
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "removal/deflection_table.h"

namespace camber::removal::upright {

/// Stores rows of a DeflectionTable by stamp number, in a ring of kMaxBytes; the oldest rows are overwritten.
class BendMemory {
 public:
  static constexpr std::size_t kMaxBytes = std::size_t{96} << 20;

  /// Sets the row size, in floats. The first row that is added belongs to stamp `first`.
  void begin(std::size_t row_size, std::size_t first) {
    if (row_size_ == row_size) return;
    first_ = first;
    row_size_ = row_size;
    capacity_ = std::max<std::size_t>(1, kMaxBytes / (row_size_ * sizeof(float)));
    values_.clear();
    stamps_ = 0;
  }
  /// Adds the row of the next stamp.
  void add(const float* row) {
    const std::size_t slot = stamps_++ % capacity_;
    if (values_.size() < (slot + 1) * row_size_) values_.resize((slot + 1) * row_size_);
    std::copy_n(row, row_size_, values_.begin() + static_cast<std::ptrdiff_t>(slot * row_size_));
  }
  /// Adds rows of stamps before `from` that were cut by another process; `rows`: one after the other.
  void add_before(std::size_t from, std::span<const float> rows, std::size_t row_size) {
    if (rows.empty()) return;
    begin(row_size, from - rows.size() / row_size);
    for (std::size_t at = 0; at < rows.size(); at += row_size) add(rows.data() + at);
  }
  bool knows(std::int32_t stamp) const {
    const std::ptrdiff_t k = stamp - static_cast<std::ptrdiff_t>(first_);
    return k >= 0 && static_cast<std::size_t>(k) < stamps_ && static_cast<std::size_t>(k) + capacity_ >= stamps_;
  }
  /// Index in values() at which a known stamp's row begins.
  std::size_t at(std::int32_t stamp) const {
    return (static_cast<std::size_t>(stamp) - first_) % capacity_ * row_size_;
  }
  const float* values() const { return values_.data(); }

 private:
  std::size_t row_size_ = 0, capacity_ = 1, first_ = 0, stamps_ = 0;
  std::vector<float> values_;
};

}  // namespace camber::removal::upright
