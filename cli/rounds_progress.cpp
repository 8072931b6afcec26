#include "cli/rounds_progress.h"

#include <algorithm>

#include <fmt/format.h>

namespace camber::cli {
namespace {

constexpr int kUsualRounds = 3;

bool is_round(std::string_view what) { return what.rfind("round ", 0) == 0; }

}  // namespace

RoundsProgress::RoundsProgress(int max_rounds, int further)
    : max_rounds_(max_rounds), further_(further), expected_rounds_(std::min(kUsualRounds, max_rounds)) {}

RoundsProgress::Whole RoundsProgress::at(std::string_view what, double share) {
  if (what != step_) {
    step_ = what;
    ++begun_;
    if (rounds_ == 0 && !is_round(what)) ++before_;
    if (is_round(what)) ++rounds_;
  }
  if (is_round(what)) expected_rounds_ = std::max(expected_rounds_, rounds_);
  if (!is_round(what) && rounds_ > 0) expected_rounds_ = rounds_;
  const int expected = std::max(begun_, before_ + expected_rounds_ + further_);
  std::string text(what);
  if (is_round(what))
    text += fmt::format(" of about {} ({} at most)", expected_rounds_, std::max(max_rounds_, rounds_));
  return {std::move(text), (begun_ - 1 + std::clamp(share, 0.0, 1.0)) / expected};
}

}  // namespace camber::cli
