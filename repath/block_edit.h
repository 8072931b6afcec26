#pragma once
// One block's text with words replaced, added or taken out; all other characters stay.
#include <string>
#include <string_view>
#include <vector>

#include "nc/program.h"

namespace camber::repath {

class BlockEdit {
 public:
  BlockEdit(const nc::Program& program, std::size_t block);

  /// The last word of the block with this letter; nullptr: none.
  const nc::Word* find(char letter) const;
  /// The last G word of the block whose value is one of these; nullptr: none.
  const nc::Word* find_code(char letter, std::initializer_list<double> values) const;
  std::string_view number(const nc::Word& word) const;

  void take_out(const nc::Word& word);
  /// The letter stays; `number`: its new text.
  void replace(const nc::Word& word, const std::string& number);
  /// Behind the words of places and codes that the block has. In the order of the calls.
  void add(char letter, const std::string& number);
  /// In front of all words but N.
  void add_code(const std::string& word);
  /// As find() and replace(), or add().
  void set(char letter, const std::string& number);

  bool changed() const { return !changes_.empty() || !added_.empty(); }
  std::string text() const;
  /// A line of these words in the way of the block: blanks, case, block skip.
  std::string further(const std::vector<std::string>& words) const;
  bool has_words() const { return !words_.empty(); }

 private:
  struct Change {
    std::size_t at, length;
    std::string text;
  };
  std::string in_case(std::string word) const;
  bool uses_blanks() const;
  std::size_t place_of_added() const;

  const nc::Program& program_;
  const nc::Block& block_;
  std::span<const nc::Word> words_;
  std::vector<Change> changes_;
  std::string added_;
};

}  // namespace camber::repath
