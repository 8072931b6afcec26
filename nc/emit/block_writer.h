#pragma once
// Writes one block's text with some of its words changed.
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "nc/emit/number_style.h"
#include "nc/emit/text_rules.h"
#include "nc/program_text.h"

namespace camber::nc {

/// Collects changes of words and renders the block. Everything that is not changed stays byte for byte.
class BlockWriter {
 public:
  BlockWriter(const Program& program, std::uint32_t block, const NumberStyle& style, const TextRules& rules);

  /// The block's word with the letter (the last one), or nullptr.
  const Word* find(char letter) const;
  /// The value that the word will have: the new one where it was set; 0 where there is no word.
  double value(char letter) const;
  /// Decimals that a number in place of this word may have: its own or `least`, whichever is more.
  int decimals(char letter, int least) const;

  /// Gives a word a new value. A value that rounds to the one in the text leaves the word alone; a word that is
  /// missing is added beside its neighbours.
  void set(char letter, double value, int decimals) { set({letter, value, decimals}); }
  void set(const NewWord& word);

  /// Leaves a word of the block out, with the blank before it.
  void take_out(const Word& word);

  /// A piece of the block's text becomes another one.
  void replace(std::size_t offset, std::size_t length, std::string text);
  /// A line to stand before the block.
  void put_before(std::string line) { line_before_ = std::move(line); }

  bool changed() const { return !changes_.empty() || !line_before_.empty(); }
  std::uint32_t block() const { return index_; }
  const NumberStyle& style() const { return style_; }
  /// The block without its line end, behind the line before it and `line_end`.
  std::string text(std::string_view line_end) const;
  /// A further block with just these words, in the block's style, and words of this block as they are.
  std::string further_block(std::span<const NewWord> words, std::span<const Word> own = {}) const;
  bool uses_blanks() const { return blanks_; }

 private:
  struct Change {
    std::size_t at;      ///< position in the file
    std::size_t length;  ///< length of what is replaced
    std::string text;
    char letter;
    double value;
  };
  std::string text_of(const NewWord& word, std::string_view like = {}) const;
  void add(const NewWord& word);
  bool block_uses_blanks() const;

  const Program& program_;
  const std::uint32_t index_;
  const Block& block_;
  std::span<const Word> words_;
  const NumberStyle& style_;
  const TextRules& rules_;
  bool blanks_;
  std::string line_before_{};
  std::vector<Change> changes_;
};

}  // namespace camber::nc
