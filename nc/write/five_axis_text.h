#pragma once
// How a language writes programs with rotary axes: tool-centre-point control, a frame for one direction of the tool,
// blocks that become one or several lines. repath/post/post_processing.h decides what is written, and posture/; a
// language says how.
#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "base/geometry.h"
#include "nc/emit/number_style.h"
#include "nc/emit/text_rules.h"
#include "nc/move.h"
#include "nc/program_text.h"

namespace camber::nc {

// One block's text with words replaced, added or taken out; all other characters stay.

class BlockEdit {
 public:
  /// Places at which a language adds words to a block.
  struct Layout {
    std::string_view places = "XYZABC";  ///< new coordinates go behind words with these letters
    std::string_view feed{};             ///< the feed goes behind words with these letters, too
    std::string_view codes = "NGH";      ///< letters used where the block has none of the others
    /// Position used where the block has none of all these; kNowhere: in front of the first word.
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
  /// Takes out a piece of the text, with the blank before it.
  void take_out(std::size_t offset, std::size_t length);
  /// Replaces the number of a word and keeps its letter. `number`: the new text.
  void replace(const Word& word, const std::string& number);
  void replace(std::size_t offset, std::size_t length, std::string text);
  /// Adds a word behind the block's words of places and codes, in the order of the calls.
  void add(char letter, const std::string& number);
  /// Adds a word at the place of the feed, such as FMAX.
  void add_feed_word(const std::string& word);
  /// Adds a word in front of all words except N.
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

/// A frame for blocks at one direction of the tool.
struct FrameLines {
  std::vector<std::string> before, behind;                        ///< lines that switch it on and off
  Eigen::Matrix3d work_from_frame = Eigen::Matrix3d::Identity();  ///< that of the angles as they are written
};

/// Words of a line that a block gets in addition.
struct LineWords {
  bool rapid = false;
  bool in_force = false;  ///< the motion (rapid or line) is that of the block before
  std::vector<std::string> places;
  std::string feed;                 ///< with its address; empty: none
  std::vector<std::string> at_end;  ///< words that act at the end of the motion
};

class FiveAxisText {
 public:
  FiveAxisText(const Program& program, const Dialect& dialect);
  virtual ~FiveAxisText() = default;

  const TextRules& rules() const { return *rules_; }
  const NumberStyle& style() const { return style_; }
  const NumberStyle& feed_style() const { return feed_style_; }

  // Tool-centre-point control
  /// The words that switch it on, for messages: "M128 or FUNCTION TCPM".
  virtual std::string_view control_words() const = 0;
  /// Follows the modal words of the given text: each block once, in order.
  virtual void pass(std::uint32_t) {}
  /// Lines in front of a block.
  virtual std::vector<std::string> control_on(std::uint32_t block) const = 0;
  virtual std::vector<std::string> control_off() const = 0;
  /// Takes words out that would switch it off in the middle of rewritten blocks.
  virtual void keep_control(BlockEdit&) const {}
  /// Takes it out of the text.
  virtual void take_out_control(BlockEdit&) const = 0;
  /// Why the joints of this move under tool-centre-point control have no words; empty: they have.
  virtual std::string joints_refused(const Interpretation&, const Move&) const { return {}; }

  // Blocks
  virtual BlockEdit edit_of(std::uint32_t block) const { return {program_, block}; }
  /// The number of this word may be changed as it stands; else it becomes a new word: X=IC(5), C=DC(90), IX+5.
  virtual bool keeps_form(const Word&) const { return true; }
  virtual void take_out(BlockEdit& edit, const Word& word) const { edit.take_out(word); }
  /// Takes out the words of an arc, or of the tool's direction.
  virtual void take_out_curve(BlockEdit& edit, bool arc, bool direction) const = 0;
  /// Makes the block a line or a rapid.
  virtual void make_line(BlockEdit& edit, bool rapid, bool in_force) const = 0;
  /// Takes out feeds that F replaces. Returns true if there were some.
  virtual bool take_out_other_feeds(BlockEdit&) const { return false; }
  /// Returns a further line beside a block.
  virtual std::string further_line(const BlockEdit& like, const LineWords& words) const;
  /// Returns a rapid on a line of its own.
  virtual std::string rapid_line(const std::vector<std::string>& words) const = 0;
  /// Returns lines that name where the linear axes already are, behind rewritten blocks. `steps`: in increments.
  virtual std::vector<std::string> place_lines(const std::vector<std::string>& words, bool rapid, bool steps) const = 0;

  // Feed
  /// Returns why feeds cannot be written in this mode; empty: they can.
  virtual std::string feed_refused(FeedMode) const { return {}; }
  /// Returns the mode that a block of the given text switches on.
  virtual std::optional<FeedMode> feed_mode_of(std::uint32_t block) const = 0;
  /// Sets the block's own mode word to this mode. Returns false if it has none.
  virtual bool set_feed_mode(BlockEdit& edit, FeedMode mode) const = 0;
  /// Returns a line that switches the mode, sets F, or both.
  virtual std::string feed_line(std::optional<FeedMode> mode, const std::string& feed) const = 0;

  // One direction of the tool
  /// A frame with Z along `axis` and X as near to that of the program as it gets. `negative`: the first rotary axis
  /// turns to a negative angle.
  virtual FrameLines tilted_frame(const Vec3& axis, int decimals, bool negative) const = 0;
  /// Lines of the dynamic work offset, on and off.
  virtual FrameLines dynamic_frame() const { return {}; }

  /// "A12.5".
  std::string word(char letter, double value, int decimals) const {
    return letter + format_number(value, decimals, style_);
  }

 protected:
  /// Adds the words at the beginning and the end of the line, beside its places.
  virtual void add_motion(const LineWords& words, std::vector<std::string>& out) const = 0;

  const Program& program_;
  const Dialect& dialect_;
  std::unique_ptr<TextRules> rules_;
  NumberStyle style_, feed_style_;
};

/// Texts with codes: G0 to G3 hold until the next, G93 to G95 say what F means.
class FiveAxisCodes : public FiveAxisText {
 public:
  using FiveAxisText::FiveAxisText;

  void make_line(BlockEdit& edit, bool rapid, bool in_force) const override;
  std::string rapid_line(const std::vector<std::string>& words) const override;
  std::vector<std::string> place_lines(const std::vector<std::string>& words, bool rapid, bool steps) const override;
  std::optional<FeedMode> feed_mode_of(std::uint32_t block) const override;
  bool set_feed_mode(BlockEdit& edit, FeedMode mode) const override;
  std::string feed_line(std::optional<FeedMode> mode, const std::string& feed) const override;

 protected:
  void add_motion(const LineWords& words, std::vector<std::string>& out) const override;
};

/// Euler angles about Z, the new X and the new Z, rad, of a frame with Z along `axis` and X as near to that of the
/// program as it gets.
Vec3 leaning_frame(const Vec3& axis);
/// `angles_rad` as they are read from words with so many decimals of a degree.
Vec3 rounded_angles(const Vec3& angles_rad, int decimals);

/// The control's dialect where it has the language of the program; else one of that language.
const Dialect& dialect_of_text(const Program& program, const Dialect& control);

/// In the language of the program.
std::unique_ptr<FiveAxisText> five_axis_text(const Program& program, const Dialect& control);
std::unique_ptr<FiveAxisText> iso_five_axis_text(const Program& program, const Dialect& dialect);

}  // namespace camber::nc
