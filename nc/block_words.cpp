#include "nc/block_words.h"

#include <cmath>

#include <fmt/format.h>

namespace camber::nc {
namespace {

int tenths_of(double value) {
  const double tenths = value * 10;
  const double rounded = std::round(tenths);
  return tenths >= 0 && tenths < 1e6 && std::abs(tenths - rounded) < 1e-6 ? static_cast<int>(rounded) : -1;
}

}  // namespace

void BlockWords::read(std::span<const Word> words, Reporter& report) {
  given_ = used_ = 0;
  g_.clear();
  m_.clear();
  corner_words_.clear();
  offset_ = words.empty() ? 0 : words.front().offset;
  for (const Word& w : words) {
    if (w.letter == 'G') {
      g_.push_back({tenths_of(w.value), &w});
    } else if (w.letter == 'M') {
      m_.push_back({tenths_of(w.value), &w});
    } else if (is_corner_word(w)) {
      corner_words_.push_back(&w);
    } else {
      if (has(w.letter) && w.letter != 'N')
        report.error(w.offset, "word-twice", fmt::format("{} appears twice in the block; one was expected", w.letter));
      given_ |= bit(w.letter);
      value_[index(w.letter)] = w.value;
      word_[index(w.letter)] = &w;
    }
  }
}

bool BlockWords::has_any(const char* letters) const {
  for (; *letters != '\0'; ++letters)
    if (has(*letters)) return true;
  return false;
}

void BlockWords::use(const char* letters) {
  for (; *letters != '\0'; ++letters) used_ |= bit(*letters);
}

}  // namespace camber::nc
