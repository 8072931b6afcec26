#pragma once
// The text of a program whose blocks with rotary axes are rewritten. Internal to repath/post.cpp.
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "nc/dialect.h"
#include "nc/emit/emitted_text.h"
#include "nc/emit/number_style.h"
#include "nc/program.h"
#include "repath/post.h"
#include "repath/post_divide.h"
#include "repath/post_motions.h"

namespace camber::repath {

// One block's text with words replaced, added or taken out; all other characters stay.

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
  /// Replaces the word with the letter, or adds it where there is none.
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

class PostWriter {
 public:
  PostWriter(const nc::Program& program, const nc::Interpretation& moves, const machine::Machine& machine,
             const nc::Dialect& dialect, const PostOptions& options, const PostRounding& rounding);

  /// `divided[k]`: of motions[k]. Fills text, block_of_line and pieces.
  void write(const PostMotions& motions, const std::vector<DividedMotion>& divided, Posted& out);

 private:
  struct Number {
    double value;
    int decimals;
  };

  void replace_codes();
  void look_at_codes_until(std::uint32_t block);
  void write_motion(const TipMotion& motion, const DividedMotion& divided, bool first_of_run);
  void open_run(const nc::Move& move, std::vector<std::string>& lines);
  void keep_tip_control(std::uint32_t first, std::uint32_t end);
  void close_run(std::size_t last, std::size_t next);
  std::vector<std::string> codes_behind(const nc::Move& last, std::size_t next);
  std::string place_line(const nc::Move& last) const;
  void keep(const nc::Move& move);
  void write_mode(const TipMotion& motion, BlockEdit& edit, std::vector<std::string>& front);
  void write_motion_code(int code, BlockEdit* edit, std::vector<std::string>& words);
  void put_together(Posted& out);

  Vec3 text_point(const nc::Move& move, const Vec3& in_frame_mm) const;
  Vec3 wanted_point(const nc::Move& move, const PostPoint& point) const;
  Vec3 joint_point_mm(const nc::Move& move, const Vec3& linear_mm) const;
  void set_places(const nc::Move& move, const PostPoint& point, BlockEdit* edit, std::vector<std::string>& words);
  std::string place_word(const nc::Move& move, int axis, double wanted, double now, const nc::Word* like) const;
  Number feed_of(const nc::Move& move, const PostPoint& point, const Vec3& before, const Vec3& turn_deg) const;
  void set_feed(const nc::Move& move, const PostPoint& point, const Vec3& before, const Vec3& turn_deg, BlockEdit* edit,
                std::vector<std::string>& words);
  nc::FeedMode mode_of(const nc::Move& move) const;
  std::string modal_feed_word(const nc::Move& move) const;
  BlockEdit& edit_of(std::uint32_t block);

  const nc::Program& program_;
  const nc::Interpretation& moves_;
  const machine::Machine& machine_;
  const nc::Dialect& dialect_;
  const PostOptions& options_;
  const PostRounding& rounding_;
  nc::NumberStyle style_, feed_style_;
  std::string axes_;  ///< letters of the rotary axes
  Vec3 tool_axis_, gauge_mm_;

  std::map<std::uint32_t, BlockEdit> edits_;                                      ///< blocks with changed words
  std::map<std::uint32_t, std::vector<std::string>> in_front_, behind_, pieces_;  ///< lines about them
  std::map<std::uint32_t, std::vector<PostedPiece>> lines_;  ///< of `pieces_`, with the block's own as the first

  // The state of the text as far as it is written.
  Vec3 at_ = Vec3::Zero(), deg_ = Vec3::Zero();  ///< X Y Z, A B C as written, in the text's unit
  Vec3 linear_mm_ = Vec3::Zero();                ///< of the linear axes there
  bool all_words_ = true;                        ///< the next block names every axis
  double feed_ = -1;                             ///< modal F; -1: not known
  nc::FeedMode feed_mode_ = nc::FeedMode::per_minute;
  int motion_code_ = 0;
  bool feed_is_ours_ = false;  ///< modal F or feed mode are not those of the given text
  bool length_active_ = false;
  std::string length_number_ = "0";  ///< of H
  std::uint32_t next_block_ = 0;     ///< whose codes were not looked at
};

}  // namespace camber::repath
