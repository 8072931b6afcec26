#pragma once
// Addresses without memory behind them.
#include <cstddef>

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

}  // namespace camber
