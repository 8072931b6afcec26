#include "nc/heidenhain/cursor.h"

#include <charconv>

namespace camber::nc::heidenhain {

std::optional<double> Cursor::number() {
  if (!more()) return std::nullopt;
  std::size_t i = at_;
  bool negative = false;
  if (text_[i] == '+' || text_[i] == '-') {
    negative = text_[i++] == '-';
    while (i < end_ && (text_[i] == ' ' || text_[i] == '\t')) ++i;
  }
  std::string digits;
  bool point = false, any = false;
  for (; i < end_; ++i) {
    const char c = text_[i];
    if (is_digit(c)) {
      digits += c;
      any = true;
    } else if ((c == '.' || c == ',') && !point) {
      digits += '.';
      point = true;
    } else {
      break;
    }
  }
  if (!any) return std::nullopt;
  if (i + 1 < end_ && upper(text_[i]) == 'E' &&
      (is_digit(text_[i + 1]) || text_[i + 1] == '-' || text_[i + 1] == '+')) {
    std::size_t j = i + 1 + (is_digit(text_[i + 1]) ? 0 : 1);
    if (j < end_ && is_digit(text_[j])) {
      digits += 'e';
      if (text_[i + 1] == '-') digits += '-';
      for (; j < end_ && is_digit(text_[j]); ++j) digits += text_[j];
      i = j;
    }
  }
  double value = 0;
  const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (read.ec != std::errc()) return std::nullopt;
  at_ = i;
  return negative ? -value : value;
}

std::optional<int> Cursor::integer() {
  if (!more() || !is_digit(text_[at_])) return std::nullopt;
  long long value = 0;
  while (at_ < end_ && is_digit(text_[at_])) {
    if (value < 1'000'000'000) value = 10 * value + (text_[at_] - '0');
    ++at_;
  }
  return value < 1'000'000'000 ? std::optional(static_cast<int>(value)) : std::nullopt;
}

std::optional<std::string> Cursor::quoted() {
  if (peek() != '"') return std::nullopt;
  const std::size_t close = text_.find('"', at_ + 1);
  if (close == std::string_view::npos || close >= end_) return std::nullopt;
  std::string out(text_.substr(at_ + 1, close - at_ - 1));
  at_ = close + 1;
  return out;
}

std::string Cursor::word() const {
  std::size_t i = at_;
  while (i < end_ && !is_blank(text_[i]) && text_[i] != ';' && i - at_ < 40) ++i;
  return std::string(text_.substr(at_, i - at_));
}

}  // namespace camber::nc::heidenhain
