#include "base/sparse_list.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <new>
#include <utility>

namespace camber {
namespace {

constexpr std::size_t kTogether = std::size_t{1} << 18;  // bytes opened at once, where they follow each other

std::size_t page_bytes() {
  static const auto bytes = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  return bytes;
}

}  // namespace

AddressRoom::AddressRoom(std::size_t bytes) : bytes_((bytes + page_bytes() - 1) / page_bytes() * page_bytes()) {
  if (bytes_ == 0) return;
  void* const room = mmap(nullptr, bytes_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (room == MAP_FAILED) throw std::bad_alloc();
  data_ = room;
}

AddressRoom::~AddressRoom() {
  if (data_) munmap(data_, bytes_);
}

AddressRoom::AddressRoom(AddressRoom&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)),
      bytes_(std::exchange(other.bytes_, 0)),
      open_end_(std::exchange(other.open_end_, 0)) {}

AddressRoom& AddressRoom::operator=(AddressRoom&& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(bytes_, other.bytes_);
  std::swap(open_end_, other.open_end_);
  return *this;
}

void AddressRoom::open_pages(std::size_t from, std::size_t count) {
  const std::size_t begin = std::max(open_end_, from / page_bytes() * page_bytes());
  // Where one part follows the other, many pages at a time: what is not written takes no memory.
  const std::size_t ahead = begin == open_end_ ? kTogether : 0;
  const std::size_t end = std::min(bytes_, (from + count + ahead + page_bytes() - 1) / page_bytes() * page_bytes());
  if (mprotect(static_cast<char*>(data_) + begin, end - begin, PROT_READ | PROT_WRITE) != 0) throw std::bad_alloc();
  open_end_ = end;
}

}  // namespace camber
