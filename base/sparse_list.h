#pragma once
// A long list of which only some parts are in memory, and the addresses for it.
#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace camber {

/// Room for some bytes, aligned for everything. Memory is there only where it was opened; elsewhere a read ends the
/// process. Throws std::bad_alloc.
class AddressRoom {
 public:
  explicit AddressRoom(std::size_t bytes = 0);
  ~AddressRoom();
  AddressRoom(AddressRoom&& other) noexcept;
  AddressRoom& operator=(AddressRoom&& other) noexcept;
  AddressRoom(const AddressRoom&) = delete;
  AddressRoom& operator=(const AddressRoom&) = delete;

  void* data() const { return data_; }
  /// Bytes from ... from + count - 1, zero at first, may be read and written. In ascending order of `from`.
  void open(std::size_t from, std::size_t count) {
    if (from + count > open_end_) open_pages(from, count);
  }

 private:
  void open_pages(std::size_t from, std::size_t count);

  void* data_ = nullptr;
  std::size_t bytes_ = 0;
  std::size_t open_end_ = 0;  ///< end of the pages opened last
};

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
