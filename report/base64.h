#pragma once
// Arrays of numbers as base64 of little-endian bytes, for pages and XML files.
#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace camber::report {

/// RFC 4648, with padding.
std::string base64(std::string_view bytes);

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
