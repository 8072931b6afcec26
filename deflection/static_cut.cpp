#include "deflection/static_cut.h"

#include <algorithm>
#include <limits>

namespace camber::deflection {

namespace {

constexpr double kTrust = 0.25;  ///< of a change, what the next one is at most where nothing else is known
constexpr double kFall = 0.6;    ///< a reading should bring the change down to this share
constexpr double kShorter = 0.7;
constexpr double kMinShare = 0.3;  ///< of the way to the equilibrium

}  // namespace

void StaticCut::start(std::size_t from, std::size_t count, removal::DeflectionTable& deflections) {
  from_ = from;
  deflections_ = &deflections;
  engager_.start(from, count, deflections);
}

StaticCut::Passing StaticCut::cut(std::size_t k) {
  const auto at = static_cast<std::ptrdiff_t>(k);
  const std::span<float> row(deflections_->row(at), deflections_->row_size());
  const float* guess = deflections_->row(at - 1);
  std::copy_n(guess, row.size(), row.begin());
  Passing out;
  out.settled = false;
  double share = 1, before_um = std::numeric_limits<double>::infinity();
  while (!out.settled && out.rounds < options_.max_rounds) {
    const auto read = engager_.read(k);
    read_.assign(read.begin(), read.end());
    const auto step = equilibrium_.solve(read_, from_ + k, stamps_[from_ + k], share, row);
    ++out.rounds;
    if (!(deflections_->largest_mm(at) <= removal::DeflectedEngager::kMaxDeflection_mm)) {
      std::copy_n(guess, row.size(), row.begin());
      break;
    }
    const double next_um = step.rms_um * std::max(kTrust, step.rms_um / before_um);
    out.settled = next_um < std::max(options_.settle_um, options_.settle_fraction * step.size_um);
    // What swings from reading to reading is stilled by shorter steps.
    if (step.rms_um > kFall * before_um) share = std::max(kMinShare, kShorter * share);
    before_um = step.rms_um;
  }
  engager_.cut(k);
  chips_.clear();
  for (const removal::DeflectedChipSample& c : read_)
    if (c.chip.thickness_mm > 0) chips_.push_back(c.chip);
  out.chips = chips_;
  return out;
}

}  // namespace camber::deflection
