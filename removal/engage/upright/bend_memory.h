#pragma once
// The deflections of the stamps that were cut last, for those who read the surfaces that they have left.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "removal/deflection_table.h"

namespace camber::removal::upright {

/// Rows of a DeflectionTable by the number of the stamp. The oldest are forgotten beyond a fixed size.
class BendMemory {
 public:
  static constexpr std::size_t kMaxBytes = std::size_t{96} << 20;

  /// For rows as those of `table`.
  void begin(const DeflectionTable& table) {
    if (row_size_ == table.row_size()) return;
    row_size_ = table.row_size();
    capacity_ = std::max<std::size_t>(1, kMaxBytes / (row_size_ * sizeof(float)));
    values_.clear();
    stamps_ = 0;
  }
  /// Stamps come one after the other, from the first.
  void add(const float* row) {
    const std::size_t slot = stamps_++ % capacity_;
    if (values_.size() < (slot + 1) * row_size_) values_.resize((slot + 1) * row_size_);
    std::copy_n(row, row_size_, values_.begin() + static_cast<std::ptrdiff_t>(slot * row_size_));
  }
  bool knows(std::int32_t stamp) const {
    const auto k = static_cast<std::size_t>(stamp);
    return stamp >= 0 && k < stamps_ && k + capacity_ >= stamps_;
  }
  /// Where a known stamp's row begins in values().
  std::size_t at(std::int32_t stamp) const { return static_cast<std::size_t>(stamp) % capacity_ * row_size_; }
  const float* values() const { return values_.data(); }

 private:
  std::size_t row_size_ = 0, capacity_ = 1, stamps_ = 0;
  std::vector<float> values_;
};

}  // namespace camber::removal::upright
