// Klartext with rotary axes: M128 and M129, PLANE SPATIAL, L in place of LN, C and CR.
#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "base/units.h"
#include "nc/frames.h"
#include "nc/heidenhain/heidenhain_language.h"
#include "nc/heidenhain/klartext_tree.h"
#include "nc/write/five_axis_text.h"

namespace camber::nc::heidenhain {
namespace {

class KlartextFiveAxis : public FiveAxisText {
 public:
  KlartextFiveAxis(const Program& program, const Dialect& dialect)
      : FiveAxisText(program, dialect), tree_(tree_of(program)), statement_of_(program.blocks.size(), nullptr) {
    for (const Statement& s : tree_.statements) statement_of_[s.block] = &s;
  }

  std::string_view control_words() const override { return "M128 or FUNCTION TCPM"; }
  std::vector<std::string> control_on(std::uint32_t) const override { return {"M128"}; }
  std::vector<std::string> control_off() const override { return {"M129"}; }

  void keep_control(BlockEdit& edit) const override {
    const Statement* s = statement_of_[edit.block()];
    if (s && s->kind == Kind::tcpm) return comment_out(edit, *s);
    take_out_functions(edit, {128, 129});
  }
  void take_out_control(BlockEdit& edit) const override { keep_control(edit); }

  std::string joints_refused(const Interpretation& moves, const Move& move) const override {
    if (moves.frame_of(move).shift_only || moves.frame_of(move).plain) return {};
    return "this move is under tool-centre-point control in a tilted, turned or mirrored plane, in which the linear "
           "axes have no words of their own; PLANE RESET was expected before M128";
  }

  BlockEdit edit_of(std::uint32_t block) const override {
    BlockEdit::Layout layout{.places = "XYZABC", .feed = "rd", .codes = {}};
    if (const Statement* s = statement_of_[block]) layout.front = s->at;
    return {program_, block, layout};
  }
  bool keeps_form(const Word& word) const override { return !is_incremental(program_, word); }

  /// R of CR, DR, the vectors of LN.
  void take_out_curve(BlockEdit& edit, bool, bool) const override {
    for (const Word& w : edit.words()) {
      const bool vector = std::ranges::find(letter::kNormal, w.letter) != std::end(letter::kNormal) ||
                          std::ranges::find(letter::kTool, w.letter) != std::end(letter::kTool);
      if (vector || w.letter == letter::kSense || w.letter == 'R') edit.take_out(w);
    }
  }

  /// FMAX holds for its block alone.
  void make_line(BlockEdit& edit, bool rapid, bool) const override {
    const Statement& s = *statement_of_[edit.block()];
    const std::string& text = program_.source.text();
    std::size_t end = s.at;
    while (end > s.begin && (text[end - 1] == ' ' || text[end - 1] == '\t')) --end;
    const std::string keyword = text.substr(s.begin, end - s.begin);
    if (!keyword.empty() && keyword != "L" && keyword != "l") edit.replace(s.begin, end - s.begin, edit.in_case("L"));
    const Word* fmax = edit.find(letter::kRapid);
    if (rapid && !fmax) edit.add_feed_word("FMAX");
    if (!rapid && fmax) edit.take_out(*fmax);
  }

  bool take_out_other_feeds(BlockEdit& edit) const override {
    bool any = false;
    for (const char other : {letter::kAutoFeed, letter::kFeedPerTurn, letter::kFeedPerTooth})
      if (const Word* w = edit.find(other)) {
        edit.take_out(*w);
        any = true;
      }
    return any;
  }

  std::string rapid_line(const std::vector<std::string>& words) const override { return line(words, true); }
  std::vector<std::string> place_lines(const std::vector<std::string>& words, bool rapid, bool) const override {
    return {line(words, rapid)};
  }

  std::string feed_refused(FeedMode mode) const override {
    return mode == FeedMode::inverse_time ? "Klartext has no feed in inverse time; F per minute was expected" : "";
  }
  /// M136, M137.
  std::optional<FeedMode> feed_mode_of(std::uint32_t block) const override {
    std::optional<FeedMode> out;
    for (const Word& w : program_.words_of(block)) {
      if (w.letter != 'M') continue;
      if (w.value == 136) out = FeedMode::per_revolution;
      if (w.value == 137) out = FeedMode::per_minute;
    }
    return out;
  }
  bool set_feed_mode(BlockEdit& edit, FeedMode mode) const override {
    const Word* own = edit.find_code('M', {136, 137});
    if (own) edit.replace(*own, mode == FeedMode::per_revolution ? "136" : "137");
    return own;
  }
  std::string feed_line(std::optional<FeedMode> mode, const std::string& feed) const override {
    std::string out = "L";
    if (!feed.empty()) out += " " + feed;
    if (mode) out += *mode == FeedMode::per_revolution ? " M136" : " M137";
    return out;
  }

  /// Spatial angles turn about the fixed X, then Y, then Z.
  FrameLines tilted_frame(const Vec3& axis, int decimals, bool) const override {
    const Eigen::Matrix3d wanted = euler_zxz(leaning_frame(axis));
    const Vec3 angles =
        rounded_angles({std::atan2(wanted(2, 1), wanted(2, 2)), std::asin(std::clamp(-wanted(2, 0), -1.0, 1.0)),
                        std::atan2(wanted(1, 0), wanted(0, 0))},
                       decimals);
    FrameLines out;
    std::string line = "PLANE SPATIAL";
    for (int i = 0; i < 3; ++i)
      line += std::string(" SP") + "ABC"[i] + format_number(deg_from_rad(angles[i]), decimals, style_);
    out.before = {line + " TURN FMAX"};
    out.behind = {"PLANE RESET STAY"};
    out.work_from_frame = (Eigen::AngleAxisd(angles.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(angles.y(), Vec3::UnitY()) *
                           Eigen::AngleAxisd(angles.x(), Vec3::UnitX()))
                              .toRotationMatrix();
    return out;
  }

 protected:
  void add_motion(const LineWords& words, std::vector<std::string>& out) const override {
    out = words.places;
    if (words.rapid)
      out.emplace_back("FMAX");
    else if (!words.feed.empty())
      out.push_back(words.feed);
    out.insert(out.end(), words.at_end.begin(), words.at_end.end());
  }

 private:
  static std::string line(const std::vector<std::string>& words, bool rapid) {
    std::string out = "L";
    for (const std::string& w : words) out += " " + w;
    return out + (rapid ? " FMAX" : "");
  }

  /// M functions and their arguments (F of M128). A block without other words becomes a comment.
  void take_out_functions(BlockEdit& edit, std::initializer_list<double> codes) const {
    bool any = false, other = false, of_function = false;
    for (const Word& w : edit.words()) {
      const bool found = w.letter == 'M' && std::ranges::find(codes, w.value) != codes.end();
      of_function = found || (of_function && w.letter == letter::kArgument);
      any |= of_function;
      other |= !of_function;
    }
    const Statement* s = statement_of_[edit.block()];
    if (!any) return;
    if (!other && s) return comment_out(edit, *s);
    of_function = false;
    for (const Word& w : edit.words()) {
      const bool found = w.letter == 'M' && std::ranges::find(codes, w.value) != codes.end();
      of_function = found || (of_function && w.letter == letter::kArgument);
      if (of_function) edit.take_out(w);
    }
  }

  void comment_out(BlockEdit& edit, const Statement& s) const { edit.replace(s.begin, 0, "; "); }

  const Tree& tree_;
  std::vector<const Statement*> statement_of_;  ///< by block; null: a line that continues another
};

}  // namespace

std::unique_ptr<FiveAxisText> five_axis_text(const Program& program, const Dialect& dialect) {
  return std::make_unique<KlartextFiveAxis>(program, dialect);
}

}  // namespace camber::nc::heidenhain
