#include "report/base64.h"

#include <ostream>

namespace camber::report {

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += k <= count ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

std::string& Base64Stream::bytes() {
  if (bytes_.size() >= kMax) {
    const std::size_t whole = bytes_.size() - bytes_.size() % 3;
    out_ << base64(std::string_view(bytes_).substr(0, whole));
    bytes_.erase(0, whole);
  }
  return bytes_;
}

void Base64Stream::finish() {
  out_ << base64(bytes_);
  bytes_.clear();
}

}  // namespace camber::report
