#include "deflection/static_cut.h"

#include <algorithm>
#include <limits>

namespace camber::deflection {

namespace {

constexpr double kTrust = 0.25;  ///< of a change, what the next one is at most where nothing else is known
constexpr double kFall = 0.6;    ///< a reading should bring the change down to this share
constexpr double kShorter = 0.7;
constexpr double kLeastShare = 0.3;  ///< of the way to the equilibrium

}  // namespace

void StaticCut::start(std::size_t from, std::size_t count, removal::ShiftTable& shifts) {
  from_ = from;
  shifts_ = &shifts;
  engager_.start(from, count, shifts);
}

StaticCut::Passing StaticCut::cut(std::size_t k) {
  const auto at = static_cast<std::ptrdiff_t>(k);
  const std::span<float> row(shifts_->row(at), shifts_->row_size());
  const float* guess = shifts_->row(at - 1);
  std::copy_n(guess, row.size(), row.begin());
  Passing out;
  out.settled = false;
  double share = 1, before_um = std::numeric_limits<double>::infinity();
  while (!out.settled && out.rounds < options_.max_rounds) {
    const auto read = engager_.read(k);
    read_.assign(read.begin(), read.end());
    const auto step = equilibrium_.solve(read_, from_ + k, stamps_[from_ + k], share, row);
    ++out.rounds;
    if (!(shifts_->largest_mm(at) <= removal::BentEngager::kMostBent_mm)) {
      std::copy_n(guess, row.size(), row.begin());
      break;
    }
    const double next_um = step.rms_um * std::max(kTrust, step.rms_um / before_um);
    out.settled = next_um < std::max(options_.settle_um, options_.settle_share * step.size_um);
    // What swings from reading to reading is stilled by shorter steps.
    if (step.rms_um > kFall * before_um) share = std::max(kLeastShare, kShorter * share);
    before_um = step.rms_um;
  }
  engager_.cut(k);
  chips_.clear();
  for (const removal::BentChip& c : read_)
    if (c.chip.thickness_mm > 0) chips_.push_back(c.chip);
  out.chips = chips_;
  return out;
}

}  // namespace camber::deflection
