#pragma once
// Gives the words of one block by their letters, and keeps which of them were used.
#include <array>
#include <cassert>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "nc/program_text.h"
#include "nc/reporter.h"

namespace camber::nc {

/// A G or M word: the code in tenths, so that G54.1 is 541. Negative: no code has this number.
struct Code {
  int tenths = 0;
  const Word* word = nullptr;
};

class BlockWords {
 public:
  /// Sorts the words of a block. A repeated letter (other than G, M and N) is an error.
  void read(std::span<const Word> words, Reporter& report);

  bool has(char letter) const { return (given_ & bit(letter)) != 0; }
  /// True if the block has any of the letters.
  bool has_any(const char* letters) const;
  /// The value as written; the word counts as used. Precondition: has(letter).
  double value(char letter) {
    assert(has(letter));
    used_ |= bit(letter);
    return value_[index(letter)];
  }
  /// Returns value() times `scale`; nothing when the block has no such word.
  std::optional<double> scaled(char letter, double scale) {
    if (!has(letter)) return std::nullopt;
    return value(letter) * scale;
  }
  /// Multiplies the value of a word. Precondition: has(letter).
  void scale(char letter, double factor) {
    assert(has(letter));
    value_[index(letter)] *= factor;
  }
  /// Precondition: has(letter).
  const Word& word(char letter) const {
    assert(has(letter));
    return *word_[index(letter)];
  }
  /// The corner words of the block: ,R ,C ,A (is_corner_word).
  const std::vector<const Word*>& corner_words() const { return corner_words_; }
  void use(const char* letters);
  /// Words that nothing asked for: bits of the letters.
  std::uint32_t unused() const { return given_ & ~used_; }

  const std::vector<Code>& g() const { return g_; }
  const std::vector<Code>& m() const { return m_; }
  /// Position of the block's first word.
  std::size_t offset() const { return offset_; }
  /// Position of the word with the letter, or of the first word where there is none.
  std::size_t offset_of(char letter) const { return has(letter) ? word(letter).offset : offset_; }

 private:
  static constexpr std::size_t index(char letter) { return static_cast<std::size_t>(letter - 'A'); }
  static constexpr std::uint32_t bit(char letter) { return 1u << index(letter); }

  std::uint32_t given_ = 0, used_ = 0;
  std::array<double, 26> value_{};
  std::array<const Word*, 26> word_{};
  std::vector<Code> g_, m_;
  std::vector<const Word*> corner_words_;
  std::size_t offset_ = 0;
};

}  // namespace camber::nc
