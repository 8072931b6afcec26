#include "cli/progress.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>

#include "cli/console.h"

namespace camber::cli {
namespace {

constexpr std::chrono::milliseconds kRedrawEvery{200};
/// Below this share the time left is anybody's guess.
constexpr double kLeastShareForTime = 0.05;
constexpr int kBarWidth = 24;

}  // namespace

std::string progress_text(std::string_view what, double share, double seconds_so_far) {
  share = std::clamp(share, 0.0, 1.0);
  const auto filled = static_cast<std::size_t>(share * kBarWidth);
  std::string out = fmt::format("{:3.0f} % [{}{}] {}", std::floor(100 * share), std::string(filled, '#'),
                                std::string(kBarWidth - filled, '.'), what);
  if (share < kLeastShareForTime || seconds_so_far < 1) return out;
  const double left_s = seconds_so_far * (1 - share) / share;
  return out + (left_s < 100 ? fmt::format(", {:.0f} s left", left_s) : fmt::format(", {:.0f} min left", left_s / 60));
}

ProgressLine::ProgressLine(const GlobalOptions& options) : enabled_(!options.quiet && stderr_is_terminal()) {}

ProgressLine::~ProgressLine() { clear(); }

void ProgressLine::show(std::string_view what, double share) {
  if (!enabled_) return;
  const auto now = Clock::now();
  if (what != what_) {
    what_ = what;
    begin_ = now;
  } else if (now - last_ < kRedrawEvery) {
    return;
  }
  last_ = now;
  shown_ = true;
  fmt::print(stderr, "\r\033[K{}", progress_text(what, share, std::chrono::duration<double>(now - begin_).count()));
  std::fflush(stderr);
}

void ProgressLine::clear() {
  if (!shown_) return;
  fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
  shown_ = false;
}

ProgressCallback ProgressLine::callback() {
  return [this](std::string_view what, double share) { show(what, share); };
}

}  // namespace camber::cli
