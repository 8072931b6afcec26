#include "cli/progress.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>

#include "cli/console.h"

namespace camber::cli {
namespace {

constexpr std::chrono::milliseconds kRedrawEvery{200};
constexpr double kShownAfter_s = 1;
/// Below this share the time left is anybody's guess.
constexpr double kMinShareForTime = 0.05;
constexpr int kBarWidth = 24;

/// Seconds that the rest needs at the pace so far; nothing where nobody can say.
std::optional<double> seconds_left(std::optional<double> share, double seconds_so_far) {
  if (!share || *share < kMinShareForTime || seconds_so_far < 1) return std::nullopt;
  return seconds_so_far * (1 - std::min(*share, 1.0)) / *share;
}

Json progress_event(const std::string& what, std::optional<double> share, double seconds_so_far) {
  Json event{{"event", "progress"}, {"what", what}, {"share", nullptr}, {"left_s", nullptr}};
  if (share) event["share"] = std::clamp(*share, 0.0, 1.0);
  if (const auto left = seconds_left(share, seconds_so_far)) event["left_s"] = *left;
  return event;
}

std::string time_text(double seconds, const char* what) {
  return seconds < 100 ? fmt::format(", {:.0f} s {}", seconds, what)
                       : fmt::format(", {:.0f} min {}", seconds / 60, what);
}

}  // namespace

std::string progress_text(std::string_view what, std::optional<double> share, double seconds_so_far) {
  if (!share) return std::string(what) + time_text(seconds_so_far, "so far");
  const double done = std::clamp(*share, 0.0, 1.0);
  const auto filled = static_cast<std::size_t>(done * kBarWidth);
  std::string out = fmt::format("{:3.0f} % [{}{}] {}", std::floor(100 * done), std::string(filled, '#'),
                                std::string(kBarWidth - filled, '.'), what);
  const auto left = seconds_left(done, seconds_so_far);
  return left ? out + time_text(*left, "left") : out;
}

RunOptions run_options(ProgressLine& line, const GlobalOptions& options, std::size_t* settled) {
  RunOptions out;
  out.nan_where_unknown = true;
  out.progress = [&line](std::string_view what, double fraction) {
    if (what == "done")
      line.clear();
    else if (std::isnan(fraction))
      line.show(what);
    else
      line.show(what, fraction);
    return true;
  };
  out.warn = [&line, &options, settled](const std::vector<Diagnostic>& warnings) {
    line.clear();
    if (settled) *settled += warnings.size();
    settle(warnings, options);
  };
  return out;
}

ProgressLine::ProgressLine(const GlobalOptions& options, std::string what)
    : enabled_(events_wanted() || (!options.quiet && stderr_is_terminal())),
      what_(std::move(what)),
      begin_(Clock::now()) {
  if (enabled_) drawing_ = std::thread([this] { redraw_until_stopped(); });
}

ProgressLine::~ProgressLine() {
  if (!enabled_) return;
  clear();
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  drawing_.join();
}

void ProgressLine::show(std::string_view what, double share) { take(what, share, false); }
void ProgressLine::show_whole(std::string_view what, double share) { take(what, share, true); }
void ProgressLine::show(std::string_view what) { take(what, std::nullopt, false); }

void ProgressLine::take(std::string_view what, std::optional<double> share, bool whole) {
  if (!enabled_) return;
  const std::lock_guard lock(mutex_);
  if (!(whole && whole_) && (what != what_ || quiet_)) begin_ = Clock::now();
  whole_ = whole;
  if (what != what_) what_ = what;
  share_ = share;
  quiet_ = false;
}

void ProgressLine::redraw_until_stopped() {
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, kRedrawEvery, [this] { return stop_; }))
    if (!quiet_) draw(Clock::now());
}

void ProgressLine::draw(Clock::time_point now) {
  const double seconds = std::chrono::duration<double>(now - begin_).count();
  if (events_wanted()) return print_event(progress_event(what_, share_, seconds));
  if (!shown_ && seconds < kShownAfter_s) return;
  shown_ = true;
  fmt::print(stderr, "\r\033[K{}", progress_text(what_, share_, seconds));
  std::fflush(stderr);
}

void ProgressLine::clear() {
  if (!enabled_) return;
  const std::lock_guard lock(mutex_);
  quiet_ = true;
  if (!shown_) return;
  fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
  shown_ = false;
}

ProgressCallback ProgressLine::callback() {
  return [this](std::string_view what, double share) { show(what, share); };
}

}  // namespace camber::cli
