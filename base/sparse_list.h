#pragma once
// A long list of which only some parts are in memory.
#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/address_room.h"

namespace camber {

/// Elements from ... end - 1.
struct ListRange {
  std::size_t from = 0, end = 0;
};

/// `size` elements by number; only those that were put have memory (whole pages of them), the others must not be read.
template <class T>
class SparseList {
 public:
  static_assert(std::is_trivially_destructible_v<T>);

  explicit SparseList(std::size_t size = 0) : size_(size), room_(size * sizeof(T)) {}

  std::size_t size() const { return size_; }
  /// All of them.
  std::span<const T> all() const { return {data(), size_}; }
  /// Ascending, apart from each other.
  const std::vector<ListRange>& kept() const { return kept_; }
  std::size_t kept_count() const {
    std::size_t out = 0;
    for (const ListRange& r : kept_) out += r.end - r.from;
    return out;
  }

  /// In ascending order of `number`.
  void put(std::size_t number, const T& value) {
    if (kept_.empty() || kept_.back().end != number) kept_.push_back({number, number});
    ++kept_.back().end;
    T* const at = data() + number;
    room_.open(number * sizeof(T), sizeof(T));
    std::construct_at(at, value);
  }

 private:
  T* data() const { return static_cast<T*>(room_.data()); }

  std::size_t size_ = 0;
  AddressRoom room_;
  std::vector<ListRange> kept_;
};

}  // namespace camber
