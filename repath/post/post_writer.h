#pragma once
// The text of a program whose blocks with rotary axes are rewritten. Internal to repath/post/post_processing.cpp.
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "nc/emit/emitted_text.h"
#include "nc/program_text.h"
#include "nc/write/five_axis_text.h"
#include "repath/post/post_divide.h"
#include "repath/post/post_motions.h"
#include "repath/post/post_processing.h"

namespace camber::repath {

class PostWriter {
 public:
  PostWriter(const nc::Program& program, const nc::Interpretation& moves, const machine::Machine& machine,
             const PostOptions& options, const PostRounding& rounding);

  /// `divided[k]`: of motions[k]. Fills text, block_of_line and pieces.
  void write(const PostMotions& motions, const std::vector<DividedMotion>& divided, Posted& out);

 private:
  struct Number {
    double value;
    int decimals;
  };

  void take_out_control();
  void look_at_codes_until(std::uint32_t block);
  void write_motion(const TipMotion& motion, const DividedMotion& divided, bool first_of_run);
  void open_run(const nc::Move& move, std::vector<std::string>& lines);
  void keep_tip_control(std::uint32_t first, std::uint32_t end);
  void close_run(std::size_t last, std::size_t next);
  std::vector<std::string> codes_behind(const nc::Move& last, std::size_t next);
  std::vector<std::string> place_lines(const nc::Move& last) const;
  void keep(std::uint32_t index);
  void write_mode(const TipMotion& motion, nc::BlockEdit& edit, std::vector<std::string>& front);
  void put_together(Posted& out);

  Vec3 text_point(const nc::Move& move, const Vec3& in_frame_mm) const;
  Vec3 wanted_point(const nc::Move& move, const PostPoint& point) const;
  Vec3 joint_point_mm(const nc::Move& move, const Vec3& linear_mm) const;
  void set_places(const nc::Move& move, const PostPoint& point, nc::BlockEdit* edit, std::vector<std::string>& words);
  std::string place_word(const nc::Move& move, int axis, double wanted, double now, const nc::Word* like) const;
  Number feed_of(const nc::Move& move, const PostPoint& point, const Vec3& before, const Vec3& turn_deg) const;
  /// Returns the F of a further line.
  std::string set_feed(const nc::Move& move, const PostPoint& point, const Vec3& before, const Vec3& turn_deg,
                       nc::BlockEdit* edit);
  nc::FeedMode mode_of(const nc::Move& move) const;
  std::string modal_feed_word(const nc::Move& move) const;
  nc::BlockEdit& edit_of(std::uint32_t block);

  const nc::Program& program_;
  const nc::Interpretation& moves_;
  const machine::Machine& machine_;
  const PostOptions& options_;
  const PostRounding& rounding_;
  std::unique_ptr<nc::FiveAxisText> text_;
  std::string axes_;  ///< letters of the rotary axes
  Vec3 tool_axis_, gauge_mm_;

  std::map<std::uint32_t, nc::BlockEdit> edits_;                                  ///< blocks with changed words
  std::map<std::uint32_t, std::vector<std::string>> in_front_, behind_, pieces_;  ///< lines about them
  std::map<std::uint32_t, std::vector<PostedPiece>> lines_;  ///< of `pieces_`, with the block's own as the first

  // The state of the text as far as it is written.
  Vec3 at_ = Vec3::Zero(), deg_ = Vec3::Zero();  ///< X Y Z, A B C as written, in the text's unit
  Vec3 linear_mm_ = Vec3::Zero();                ///< of the linear axes there
  bool all_words_ = true;                        ///< the next block names every axis
  double feed_ = -1;                             ///< modal F; -1: not known
  nc::FeedMode feed_mode_ = nc::FeedMode::per_minute;
  std::optional<bool> rapid_{};   ///< the motion in force is a rapid, or a line; not given: another one
  bool feed_is_ours_ = false;     ///< modal F or feed mode are not those of the given text
  std::uint32_t next_block_ = 0;  ///< whose codes were not looked at
};

}  // namespace camber::repath
