#pragma once
// Arrays of numbers as base64 of little-endian bytes, for pages and XML files.
#include <bit>
#include <cstdint>
#include <iosfwd>
#include <span>
#include <string>
#include <string_view>

namespace camber::report {

/// RFC 4648, with padding.
std::string base64(std::string_view bytes);

/// Base64 of bytes that come piece by piece.
class Base64Stream {
 public:
  explicit Base64Stream(std::ostream& out) : out_(out) {}
  /// Room for more bytes; what is whole is written when there are many.
  std::string& bytes();
  /// Writes the rest, with padding.
  void finish();

 private:
  static constexpr std::size_t kMax = 3 << 18;  ///< whole groups of three
  std::ostream& out_;
  std::string bytes_;
};

/// Appends the little-endian bytes of an integer or a float.
template <class T>
void append_little_endian(std::string& bytes, T value) {
  if constexpr (std::is_same_v<T, float>) {
    append_little_endian(bytes, std::bit_cast<std::uint32_t>(value));
  } else {
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      bytes += static_cast<char>(value & 0xff);
      value = static_cast<T>(value >> (sizeof(T) > 1 ? 8 : 0));
    }
  }
}

template <class T>
std::string little_endian(std::span<const T> values) {
  std::string bytes;
  bytes.reserve(values.size() * sizeof(T));
  for (const T v : values) append_little_endian(bytes, v);
  return bytes;
}

}  // namespace camber::report
