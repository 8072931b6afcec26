#pragma once
// One block's text with some of its words changed.
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "nc/emit/number_style.h"
#include "nc/program.h"

namespace camber::nc {

/// A word of a block that is made anew.
struct NewWord {
  char letter = 0;
  double value = 0;
  int decimals = 0;
  const NumberStyle* style = nullptr;  ///< none: as the coordinates
};

/// Collects changes of words and renders the block. Everything that is not changed stays byte for byte.
class BlockWriter {
 public:
  BlockWriter(const Program& program, std::size_t block, const NumberStyle& style);

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

  bool changed() const { return !changes_.empty(); }
  /// The block without its line end.
  std::string text() const;
  /// A further block with just these words, in the block's style, and words of this block as they are: G words in
  /// front, others behind.
  std::string further_block(std::span<const NewWord> words, std::span<const Word> own = {}) const;
  bool uses_blanks() const { return blanks_; }

 private:
  struct Change {
    std::size_t at;      ///< offset in the file
    std::size_t length;  ///< of what is replaced
    std::string text;
    char letter;
    double value;
  };
  std::string text_of(const NewWord& word, std::string_view like = {}) const;
  void add(const NewWord& word);
  void add_feed(std::string word, double value);
  char in_case(char letter) const;
  bool block_uses_blanks() const;

  const Program& program_;
  const Block& block_;
  std::span<const Word> words_;
  const NumberStyle& style_;
  bool blanks_;
  std::vector<Change> changes_;
};

}  // namespace camber::nc
