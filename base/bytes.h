#pragma once
// Plain values as bytes and back, for files that only the same build of the program reads.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace camber {

/// Thrown by ByteReader where bytes are missing or do not make sense.
struct BytesMissing : std::runtime_error {
  BytesMissing() : std::runtime_error("bytes are missing") {}
};

class ByteWriter {
 public:
  template <class T>
  void value(const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&v), sizeof v);
  }
  /// Length, then the elements. Of types whose copy is a copy of their bytes, vectors of three numbers included.
  template <class T>
  void list(std::span<const T> values) {
    value(static_cast<std::uint64_t>(values.size()));
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  }
  template <class T>
  void list(const std::vector<T>& values) {
    list(std::span<const T>(values));
  }
  void text(std::string_view text) { list(std::span<const char>(text.data(), text.size())); }
  const std::string& bytes() const { return bytes_; }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : left_(bytes) {}

  template <class T>
  T value() {
    T out;
    copy(&out, sizeof out);
    return out;
  }
  template <class T>
  std::vector<T> list() {
    const auto count = value<std::uint64_t>();
    if (count > left_.size() / sizeof(T)) throw BytesMissing();
    std::vector<T> out(count);
    copy(out.data(), count * sizeof(T));
    return out;
  }
  std::string text() {
    const std::vector<char> out = list<char>();
    return {out.begin(), out.end()};
  }
  std::size_t left() const { return left_.size(); }

 private:
  void copy(void* to, std::size_t size) {
    if (size > left_.size()) throw BytesMissing();
    if (size > 0) std::memcpy(to, left_.data(), size);
    left_.remove_prefix(size);
  }
  std::string_view left_;
};

}  // namespace camber
