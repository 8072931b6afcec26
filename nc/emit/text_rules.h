#pragma once
// Text rules: how a language writes the words that an edit changes. The emitter decides what each block becomes; the
// rules say how the language puts it. One object for each emission: rules may follow what was written.
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "nc/emit/arc_rounding.h"
#include "nc/emit/number_style.h"
#include "nc/move.h"
#include "nc/program.h"

namespace camber::nc {

class BlockWriter;

/// What a block holds beside the coordinates, the feed and the block number of a straight cut.
enum class Beside : std::uint8_t { nothing, comment, word, expression, skip, several };

/// A word of a block that is made anew.
struct NewWord {
  char letter = 0;
  double value = 0;
  int decimals = 0;
  const NumberStyle* style = nullptr;  ///< none: as the coordinates
};

/// Letters of Program::words are X Y Z for coordinates, F for the feed, I J K for arc centres and R for a radius in
/// every language, whatever the text says (IX+5, X=IC(5), CR=8).
class TextRules {
 public:
  explicit TextRules(const Program& program) : program_(program) {}
  virtual ~TextRules() = default;

  // What a block does
  /// It takes axes to machine coordinates, which edits leave alone (G53, G28; M91; SUPA).
  virtual bool goes_to_machine_place(std::uint32_t block) const = 0;
  /// It also calls or ends a subprogram: it cannot be split.
  virtual bool calls(std::uint32_t block) const = 0;
  /// Words that act at the end of its move: of a block that is split they go to the last piece.
  virtual std::vector<Word> words_at_end(std::uint32_t block) const = 0;
  /// The program reads its modal feed, or something relies on it that has no F word of its own.
  virtual bool reads_feed() const { return false; }

  // Spindle speed
  /// The block's S word of this speed, where it is a number.
  virtual std::optional<Word> speed_word(std::uint32_t block, double rpm) const {
    for (const Word& w : program_.words_of(block))
      if (w.letter == 'S' && w.value == rpm) return w;
    return std::nullopt;
  }
  /// A line of its own with a speed. `address`: text of another S word before its number: "S", "S1=".
  virtual std::string speed_line(const std::string& address, const std::string& number) const {
    return address + number;
  }

  // Coordinates
  /// Returns whether the axis word counts from where the tool stands; `word` null: a word that would be added.
  virtual bool incremental(const ModalState& state, const Word* word) const = 0;

  // Text
  /// Adds to the number style what style_of does not see.
  virtual void adapt(NumberStyle&) const {}
  /// A new word: "X12.5", "X+12.5", "CR=8". `number` is in the style of the program.
  virtual std::string new_word(std::uint32_t block, char letter, const std::string& number) const = 0;
  /// Place of a new word in the block, and whether the blank that parts it from its neighbour comes before it.
  struct Place {
    std::size_t offset = 0;
    bool behind = true;  ///< a neighbour; else in front of one
  };
  virtual Place place_of(std::uint32_t block, char letter) const = 0;
  /// A further block of these words, and of words of `block` as they are.
  virtual std::string further_block(std::uint32_t block, bool blanks, std::span<const std::string> words,
                                    std::span<const Word> own) const = 0;
  /// Gives new lines among these their block numbers, where the program has numbers on every line.
  virtual std::string numbered(std::string lines) const { return lines; }
  /// A line of comment.
  virtual std::string comment(std::string_view text) const = 0;
  /// The block before which a header of comments goes.
  virtual std::size_t header_block() const = 0;

  // Arcs
  virtual bool by_radius(std::uint32_t block) const = 0;
  virtual bool absolute_centre(const ModalState& state, std::uint32_t block) const = 0;
  /// The block's own arc gets this centre or radius.
  virtual void set_arc(BlockWriter& writer, const WantedArc& wanted, const RoundedArc& arc, double unit_mm,
                       int decimals) = 0;
  /// A further arc behind it: the block's text. `words`: end point and feed.
  virtual std::string further_arc(BlockWriter& writer, std::vector<NewWord> words, const WantedArc& wanted,
                                  const RoundedArc& arc, double unit_mm, int decimals, std::span<const Word> own) = 0;
  /// Returns lines to put before a block, where earlier edits have changed what it relies on beside position and feed
  /// (a pole); empty: none.
  virtual std::string lines_before(std::uint32_t) { return {}; }

  // Runs of cuts that are written anew
  /// A block says how it moves only where that changes (G0 to G3); else each block says it.
  virtual bool motion_is_modal() const = 0;
  /// Something may jump to block numbers.
  virtual bool numbers_are_targets() const = 0;
  /// Where motion is not modal: what keeps the block from being written together with others.
  virtual Beside beside(std::uint32_t) const { return Beside::nothing; }
  /// What blocks behind `last` rely on and arcs between `first` and `last` have changed (a pole): lines to put behind.
  virtual std::vector<std::string> lines_behind(std::uint32_t, std::uint32_t) const { return {}; }
  /// A new line, with a block number for renumbered() where the program has them on every line.
  virtual std::string new_line(std::string line) const { return line; }
  /// A whole program in which lines were added and taken out, its block numbers in order.
  virtual std::string renumbered(std::string text) const { return text; }

 protected:
  const Program& program_;
};

}  // namespace camber::nc
