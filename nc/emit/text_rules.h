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
#include "nc/program_text.h"

namespace camber::nc {

class BlockWriter;

/// Contents of a block beside the coordinates, the feed and the block number of a straight cut.
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
  /// Returns whether the block moves axes to machine coordinates, which edits leave alone (G53, G28; M91; SUPA).
  virtual bool goes_to_machine_place(std::uint32_t block) const = 0;
  /// Returns whether the block also calls or ends a subprogram, so that it cannot be split.
  virtual bool calls(std::uint32_t block) const = 0;
  /// Returns the words that act at the end of the block's move; a split block has them in its last piece.
  virtual std::vector<Word> words_at_end(std::uint32_t block) const = 0;
  /// Returns whether the program reads its modal feed, or a block without an F word relies on it.
  virtual bool reads_feed() const { return false; }

  // Spindle speed
  /// Returns the block's S word of this speed, where it is a number.
  virtual std::optional<Word> speed_word(std::uint32_t block, double rpm) const {
    for (const Word& w : program_.words_of(block))
      if (w.letter == 'S' && w.value == rpm) return w;
    return std::nullopt;
  }
  /// Returns a line that sets a speed. `address`: the text of another S word before its number: "S", "S1=".
  virtual std::string speed_line(const std::string& address, const std::string& number) const {
    return address + number;
  }

  // Coordinates
  /// Returns whether the axis word counts from where the tool stands; `word` null: a word that would be added.
  virtual bool incremental(const ModalState& state, const Word* word) const = 0;

  // Text
  /// Adds to the number style what style_of does not see.
  virtual void adapt(NumberStyle&) const {}
  /// Returns a new word: "X12.5", "X+12.5", "CR=8". `number` is in the style of the program.
  virtual std::string new_word(std::uint32_t block, char letter, const std::string& number) const = 0;
  /// Place of a new word in the block, and whether the blank that parts it from its neighbour comes before it.
  struct Place {
    std::size_t offset = 0;
    bool behind = true;  ///< a neighbour; else in front of one
  };
  virtual Place place_of(std::uint32_t block, char letter) const = 0;
  /// Returns a further block with these words, and with `own` words of `block` as they are.
  virtual std::string further_block(std::uint32_t block, bool blanks, std::span<const std::string> words,
                                    std::span<const Word> own) const = 0;
  /// Gives new lines among these their block numbers, where the program has numbers on every line.
  virtual std::string numbered(std::string lines) const { return lines; }
  /// A line of comment.
  virtual std::string comment(std::string_view text) const = 0;
  /// Returns the block before which a header of comments is put.
  virtual std::size_t header_block() const = 0;

  // Arcs
  virtual bool by_radius(std::uint32_t block) const = 0;
  virtual bool absolute_centre(const ModalState& state, std::uint32_t block) const = 0;
  /// Gives the block's own arc this centre or radius.
  virtual void set_arc(BlockWriter& writer, const WantedArc& wanted, const RoundedArc& arc, double unit_mm,
                       int decimals) = 0;
  /// Returns the text of a block with a further arc behind it. `words`: end point and feed.
  virtual std::string further_arc(BlockWriter& writer, std::vector<NewWord> words, const WantedArc& wanted,
                                  const RoundedArc& arc, double unit_mm, int decimals, std::span<const Word> own) = 0;
  /// Returns lines to put before a block, where earlier edits have changed what it relies on beside position and feed
  /// (a pole); empty: none.
  virtual std::string lines_before(std::uint32_t) { return {}; }

  // Runs of cuts that are written anew
  /// Returns whether motion words (G0 to G3) are modal; else each block has one.
  virtual bool motion_is_modal() const = 0;
  /// Returns whether block numbers may be targets of jumps.
  virtual bool numbers_are_targets() const = 0;
  /// Returns the contents that keep a block from being written together with others; used where motion is not modal.
  virtual Beside beside(std::uint32_t) const { return Beside::nothing; }
  /// Returns lines to put behind `last` that restore what arcs from `first` to `last` have changed (a pole).
  virtual std::vector<std::string> lines_behind(std::uint32_t, std::uint32_t) const { return {}; }
  /// Returns a new line, with a block number for renumbered() where the program has one on every line.
  virtual std::string new_line(std::string line) const { return line; }
  /// Puts the block numbers of a whole program in order after lines were added and removed.
  virtual std::string renumbered(std::string text) const { return text; }

 protected:
  const Program& program_;
};

/// Writes arcs of languages that give the centre by I J K and the radius by R.
class LetterArcs : public TextRules {
 public:
  using TextRules::TextRules;

  bool by_radius(std::uint32_t block) const override;
  void set_arc(BlockWriter& writer, const WantedArc& wanted, const RoundedArc& arc, double unit_mm,
               int decimals) override;
  std::string further_arc(BlockWriter& writer, std::vector<NewWord> words, const WantedArc& wanted,
                          const RoundedArc& arc, double unit_mm, int decimals, std::span<const Word> own) override;
  bool motion_is_modal() const override { return true; }

 protected:
  static constexpr char kCentre[] = "IJK";  ///< one letter per axis
};

}  // namespace camber::nc
