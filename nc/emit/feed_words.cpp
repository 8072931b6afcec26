#include "nc/emit/feed_words.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"

namespace camber::nc {
namespace {

constexpr double kSameFeed = 1e-9;      ///< relative; far below any decimal
constexpr double kFeedRounding = 1e-3;  ///< a feed may be rounded by so much of it
constexpr double kOtherUnit = 1e-6;     ///< relative, of a modal feed given in the other unit
constexpr int kMaxDecimals = 7;

bool same(double a, double b) { return std::abs(a - b) <= kSameFeed * std::max(std::abs(a), std::abs(b)); }

}  // namespace

void FeedWords::begin(const Move& move) {
  if (move.feed_given) astray_.reset();
}

double FeedWords::unit_mm(const Move& move) const { return moves_->state_of(move).inch ? kMmPerInch : 1.0; }

double FeedWords::modal_of(const Move& move, double feed_mm_per_s) const {
  const ModalState& state = moves_->state_of(move);
  const double per_min = mm_per_min_from_mm_per_s(feed_mm_per_s);
  return state.feed_mode == FeedMode::per_revolution ? per_min / state.spindle_speed_rpm : per_min;
}

void FeedWords::set_modal(double now, double given) {
  if (same(now, given))
    astray_.reset();
  else
    astray_ = Astray{now, given};
}

void FeedWords::read_style() {
  if (style_) return;
  style_ = feed_style_of(*program_);
  decimals_ = feed_decimals_of(*program_);
}

/// Returns as many decimals as the program's F words have, or more where it takes them to be right.
int FeedWords::decimals_for(double value) {
  read_style();
  int decimals = decimals_;
  while (decimals < kMaxDecimals && 0.5 * std::pow(10.0, -decimals) > kFeedRounding * value) ++decimals;
  return decimals;
}

/// A number that was read from an F word of the program: with the decimals that it takes to be read as the same. One
/// that was given in the other unit has no end; it is right to a millionth.
NewWord FeedWords::exact(double value) {
  read_style();
  for (int decimals = 0; decimals < kMaxDecimals; ++decimals)
    if (same(rounded(value, decimals), value)) return {'F', rounded(value, decimals), decimals, &*style_};
  int decimals = 0;
  while (std::abs(rounded(value, decimals) - value) > kOtherUnit * value) ++decimals;
  return {'F', rounded(value, decimals), decimals, &*style_};
}

std::optional<NewWord> FeedWords::next(const Move& move, double feed_mm_per_s, const Word* own) {
  const double unit = unit_mm(move);
  const double given = modal_of(move, move.feed_mm_per_s), wanted = modal_of(move, feed_mm_per_s);
  const double now = own ? given : astray_ ? astray_->now : given;
  if (same(now, wanted)) {
    set_modal(now, given);
    return std::nullopt;
  }
  if (same(wanted, given)) {
    astray_.reset();
    return exact(given / unit);
  }
  const int decimals = decimals_for(wanted / unit);
  if (std::abs(now - wanted) <= 0.5 * unit * std::pow(10.0, -decimals)) {
    set_modal(now, given);
    return std::nullopt;
  }
  const NewWord word{'F', rounded(wanted / unit, decimals), decimals, &*style_};
  set_modal(word.value * unit, given);
  return word;
}

NewWord FeedWords::inverse_time(double feed_mm_per_s, double length_mm, int min_decimals) {
  const double value = mm_per_min_from_mm_per_s(feed_mm_per_s) / length_mm;
  const int decimals = std::max(min_decimals, decimals_for(value));
  return {'F', value, decimals, &*style_};
}

NewWord FeedWords::restored(const Move& last) {
  const NewWord word = exact(astray_->given / unit_mm(last));
  astray_.reset();
  return word;
}

}  // namespace camber::nc
