#pragma once
// Arrays of numbers in a page: one block of bytes, deflated, as base64.
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "base/json.h"

namespace camber::report {

/// The zlib format (RFC 1950), which browsers call "deflate". The same bytes in give the same bytes out.
std::string deflated(std::string_view bytes);

/// Collects arrays; each is described by {at, n, kind, ...}: where its bytes begin, how many values it has, how they
/// are written. Within an array the bytes of a value stand apart: first all least significant bytes, then the next
/// ones, which deflate shrinks better.
class PackedArrays {
 public:
  /// "f4": floats. NaN is "nothing here".
  Json add_floats(std::span<const double> values);
  /// "q2": value = from + step q, q in 0 ... 65534; 65535 is NaN. The least and the greatest value are exact; what lies
  /// between is within half a step, 1/131068 of the range.
  Json add_quantised(std::span<const double> values);
  /// "d4": whole numbers, each as the difference to the one before, the sign in the lowest bit.
  Json add_whole(std::span<const std::uint32_t> values);

  /// All bytes so far, deflated, as base64.
  std::string text() const;

 private:
  Json describe(std::size_t count, const char* kind) const;
  template <class T>
  void append(std::span<const T> values);

  std::string bytes_;
};

}  // namespace camber::report
