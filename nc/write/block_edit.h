#pragma once
// One block's text with words replaced, added or taken out; all other characters stay.
#include <algorithm>
#include <initializer_list>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "nc/program.h"

namespace camber::nc {

class BlockEdit {
 public:
  /// Where a language adds words to a block.
  struct Layout {
    std::string_view places = "XYZABC";  ///< letters behind which places go
    std::string_view feed{};             ///< and further ones behind which the feed goes
    std::string_view codes = "NGH";      ///< behind these, where the block has none of the others
    /// Behind this position, where it has none of all these; kNowhere: in front of the first word.
    std::size_t front = kNowhere;
    static constexpr std::size_t kNowhere = std::numeric_limits<std::size_t>::max();
  };

  BlockEdit(const Program& program, std::uint32_t block) : BlockEdit(program, block, Layout{}) {}
  BlockEdit(const Program& program, std::uint32_t block, const Layout& layout);

  std::uint32_t block() const { return index_; }
  /// The last word of the block with this letter that was not taken out; nullptr: none.
  const Word* find(char letter) const;
  /// The last word of the block with this letter whose value is one of these; nullptr: none.
  const Word* find_code(char letter, std::initializer_list<double> values) const;
  std::string_view number(const Word& word) const;

  void take_out(const Word& word);
  /// A piece of the text, with the blank before it.
  void take_out(std::size_t offset, std::size_t length);
  /// The letter stays; `number`: its new text.
  void replace(const Word& word, const std::string& number);
  void replace(std::size_t offset, std::size_t length, std::string text);
  /// Behind the words of places and codes that the block has. In the order of the calls.
  void add(char letter, const std::string& number);
  /// Where the feed goes: FMAX.
  void add_feed_word(const std::string& word);
  /// In front of all words but N.
  void add_code(const std::string& word);
  /// Replaces the word with the letter, or adds it where there is none.
  void set(char letter, const std::string& number);

  bool changed() const { return !changes_.empty() || !added_.empty() || !added_feed_.empty(); }
  std::string text() const;
  /// In the case of the block's words.
  std::string in_case(std::string word) const;
  bool uses_blanks() const;
  bool has_words() const { return !words_.empty(); }
  std::span<const Word> words() const { return words_; }
  bool is_taken_out(const Word& word) const { return std::ranges::find(taken_out_, &word) != taken_out_.end(); }

 private:
  struct Change {
    std::size_t at, length;
    std::string text;
  };
  struct Added {
    std::size_t at = 0;
    bool in_front = false;  ///< of a word
  };
  Added place_of_added(bool feed) const;
  void append(std::string& added, const std::string& word) const;

  const Program& program_;
  const std::uint32_t index_;
  const Block& block_;
  std::span<const Word> words_;
  Layout layout_;
  std::vector<Change> changes_;
  std::vector<const Word*> taken_out_;
  std::string added_, added_feed_;
};

}  // namespace camber::nc
