#include "nc/write/five_axis_text.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/language.h"

namespace camber::nc {
namespace {

constexpr std::initializer_list<double> kFeedModes{93, 94, 95};
constexpr std::initializer_list<double> kMotions{0, 1, 2, 3};

int code_of(FeedMode mode) { return mode == FeedMode::inverse_time ? 93 : mode == FeedMode::per_minute ? 94 : 95; }

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& w : words) out += (out.empty() ? "" : " ") + w;
  return out;
}

}  // namespace

FiveAxisText::FiveAxisText(const Program& program, const Dialect& dialect)
    : program_(program),
      dialect_(dialect),
      rules_(language_of(program).text_rules(program)),
      style_(style_of(program)),
      feed_style_(feed_style_of(program)) {
  rules_->adapt(style_);
  NumberStyle signs = feed_style_;  // F has no sign
  rules_->adapt(signs);
  signs.plus = false;
  feed_style_ = signs;
}

std::string FiveAxisText::further_line(const BlockEdit& like, const LineWords& words) const {
  std::vector<std::string> all;
  add_motion(words, all);
  for (std::string& w : all) w = like.in_case(std::move(w));
  return rules_->further_block(like.block(), like.uses_blanks(), all, {});
}

// --- codes

void FiveAxisCodes::make_line(BlockEdit& edit, bool rapid, bool in_force) const {
  const int code = rapid ? 0 : 1;
  const Word* own = edit.find_code('G', kMotions);
  if (own) {
    const bool two = edit.number(*own).size() == 2;
    if (own->value != code) edit.replace(*own, fmt::format("{}{}", two ? "0" : "", code));
  } else if (!in_force) {
    edit.add_code(fmt::format("G{}", code));
  }
}

void FiveAxisCodes::add_motion(const LineWords& words, std::vector<std::string>& out) const {
  if (!words.in_force) out.emplace_back(words.rapid ? "G0" : "G1");
  out.insert(out.end(), words.places.begin(), words.places.end());
  if (!words.feed.empty()) out.push_back(words.feed);
  out.insert(out.end(), words.at_end.begin(), words.at_end.end());
}

std::string FiveAxisCodes::rapid_line(const std::vector<std::string>& words) const { return "G0 " + joined(words); }

std::vector<std::string> FiveAxisCodes::place_lines(const std::vector<std::string>& words, bool rapid,
                                                    bool steps) const {
  std::vector<std::string> out{std::string(steps ? "G90 " : "") + (rapid ? "G0 " : "G1 ") + joined(words)};
  if (steps) out.emplace_back("G91");
  return out;
}

std::optional<FeedMode> FiveAxisCodes::feed_mode_of(std::uint32_t block) const {
  std::optional<FeedMode> out;
  for (const Word& w : program_.words_of(block)) {
    if (w.letter != 'G') continue;
    if (w.value == 93) out = FeedMode::inverse_time;
    if (w.value == 94) out = FeedMode::per_minute;
    if (w.value == 95) out = FeedMode::per_revolution;
  }
  return out;
}

bool FiveAxisCodes::set_feed_mode(BlockEdit& edit, FeedMode mode) const {
  const Word* own = edit.find_code('G', kFeedModes);
  if (own) edit.replace(*own, std::to_string(code_of(mode)));
  return own;
}

std::string FiveAxisCodes::feed_line(std::optional<FeedMode> mode, const std::string& feed) const {
  std::string out = mode ? fmt::format("G{}", code_of(*mode)) : std::string();
  if (!feed.empty()) out += (out.empty() ? "" : " ") + feed;
  return out;
}

// --- frames

Vec3 leaning_frame(const Vec3& axis) {
  const double lean = std::acos(std::min(1.0, axis.z())), turn = lean > 1e-9 ? std::atan2(axis.x(), -axis.y()) : 0;
  return {turn, lean, -turn};
}

Vec3 rounded_angles(const Vec3& angles_rad, int decimals) {
  Vec3 out;
  for (int i = 0; i < 3; ++i) out[i] = rad_from_deg(rounded(deg_from_rad(angles_rad[i]), decimals));
  return out;
}

// --- languages

const Dialect& dialect_of_text(const Program& program, const Dialect& control) {
  if (control.language == program.language) return control;
  const Dialect* own = dialect_named(language_of(program).name);
  return own ? *own : default_dialect();
}

std::unique_ptr<FiveAxisText> five_axis_text(const Program& program, const Dialect& control) {
  return language_of(program).five_axis_text(program, dialect_of_text(program, control));
}

}  // namespace camber::nc
