#include "deflection/static_cut.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace camber::deflection {

namespace {

constexpr double kTrust = 0.25;  ///< largest ratio of the next change to this one where nothing else is known
constexpr double kFall = 0.6;    ///< a reading should bring the change down to this share
constexpr double kShorter = 0.7, kLonger = 1.5;
constexpr int kSwings = 12;  ///< readings after which a deflection that still oscillates is damped
constexpr int kSwingRounds = 4;
constexpr double kSwingShare = 1;
constexpr double kAsForeseen = 0.8;  ///< fraction of the predicted decrease that counts as achieved
constexpr double kMinShare = 0.3;    ///< smallest fraction of the way to the equilibrium

}  // namespace

void StaticCut::start(std::size_t from, std::size_t count, removal::DeflectionTable& deflections,
                      std::function<bool(std::size_t)> must_read) {
  from_ = from, count_ = count;
  must_read_ = std::move(must_read);
  carved_ = 0, reglanced_ = count;
  deflections_ = &deflections;
  engager_.start(from, count, deflections);
}

/// Returns whether the tool is pulled in or pushed out, by its deflection along the normals of the points that cut.
NoEquilibrium StaticCut::beyond_reach(std::span<const float> row) const {
  double inwards = 0;
  for (const removal::DeflectedChipSample& c : read_) {
    const std::size_t step =
        c.chip.point % static_cast<std::uint32_t>(envelope_.steps) % static_cast<std::size_t>(deflections_->steps);
    const double x = static_cast<double>(row[2 * step]), y = static_cast<double>(row[2 * step + 1]);
    if (!std::isfinite(x) || !std::isfinite(y)) continue;
    inwards +=
        static_cast<double>(envelope_.nx[c.chip.point]) * x + static_cast<double>(envelope_.ny[c.chip.point]) * y;
    if (deflections_->axial)
      inwards += static_cast<double>(envelope_.nz[c.chip.point]) *
                 static_cast<double>(deflections_->axial_mm(row.data(), static_cast<int>(step)));
  }
  return inwards > 0 ? NoEquilibrium::pulled_in : NoEquilibrium::pushed_out;
}

/// An edge that rests where its next point begins to cut has no reading with an equilibrium of its own: one reading
/// asks for less deflection, the next for more, and shorter and shorter steps converge between them. Returns true where
/// the deflection has stayed since swing_ was kept and the readings differ by a small fraction of it.
bool StaticCut::rests(std::span<const float> row, const StaticEquilibrium::Step& step) const {
  constexpr double kAtOdds = 0.1, kAtOdds_um = 1;
  if (swing_.size() != row.size() || step.rms_um > std::max(kAtOdds_um, kAtOdds * step.size_um)) return false;
  double change2 = 0, size2 = 0;
  for (std::size_t i = 0; i < row.size(); ++i) {
    const double is = static_cast<double>(row[i]), was = static_cast<double>(swing_[i]);
    change2 += (is - was) * (is - was), size2 += is * is;
  }
  const double part = size2 > 0 ? std::sqrt(change2 / size2) : 0;
  return part * step.size_um < std::max(options_.settle_um, options_.settle_fraction * step.size_um);
}

/// Starts from the deflection of the stamp before, with the run-out of this one.
void StaticCut::start_from_before(std::size_t k, std::span<float> row) const {
  std::copy_n(deflections_->row(static_cast<std::ptrdiff_t>(k) - 1), row.size(), row.begin());
  if (from_ + k > 0) run_out_.add(from_ + k - 1, -1, deflections_->nodes(), row);
  run_out_.add(from_ + k, 1, deflections_->nodes(), row);
}

/// Extrapolates the deflection. Returns true where that is good enough; otherwise the row is the start of a reading.
bool StaticCut::follow(std::size_t k) {
  const std::span<float> row(deflections_->row(static_cast<std::ptrdiff_t>(k)), deflections_->row_size());
  const std::size_t passing = from_ + k;
  const bool may = pace_.may_follow(passing, stamps_[passing]);
  if (!pace_.has_line(passing)) return start_from_before(k, row), false;
  pace_.follow(passing, row);
  if (!(deflections_->largest_mm(static_cast<std::ptrdiff_t>(k)) <= removal::DeflectedEngager::kMaxDeflection_mm))
    return start_from_before(k, row), false;
  return may && !must_read_(k);
}

/// Returns the number of passings from k on that are not read. A glance that finds other material than foreseen is
/// repeated once the stamps before it are carved.
std::size_t StaticCut::followers(std::size_t k) {
  std::size_t count = 0;
  while (k + count < count_ && follow(k + count) && (k != reglanced_ || count == 0)) ++count;
  if (count == 0) return 0;
  const auto glances = engager_.glance(k, count);
  for (std::size_t i = 0; i < count; ++i) {
    if (pace_.as_much_material(from_ + k + i, glances[i])) continue;
    reglanced_ = k + i;
    return i;
  }
  return count;
}

void StaticCut::carve_to(std::size_t end) {
  if (end > carved_) engager_.cut(carved_, end - carved_);
  carved_ = std::max(carved_, end);
}

StaticCut::Passing StaticCut::cut(std::size_t k) {
  const auto at = static_cast<std::ptrdiff_t>(k);
  const std::span<float> row(deflections_->row(at), deflections_->row_size());
  Passing out;
  if (k >= carved_) {
    const bool pending = carved_ < k;
    carve_to(k + followers(k));
    if (pending && k == carved_ && k == reglanced_) carve_to(k + followers(k));
  }
  if (k < carved_) return out;
  out.settled = false;
  ReadingPace::Reading reading;
  swing_.clear();
  const StaticEquilibrium::Motion motion{removal::motion_in_tool(stamps_, from_ + k), stamps_[from_ + k].first};
  double share = 1, before_um = std::numeric_limits<double>::infinity();
  // Where passing after passing has no equilibrium, the next one hardly finds one in its last rounds.
  constexpr int kPatience = 20, kFewRounds = 8;
  const int most = unsettled_in_a_row_ < kPatience ? options_.max_rounds : std::min(options_.max_rounds, kFewRounds);
  while (!out.settled && out.rounds < most) {
    const auto read = engager_.read(k);
    read_.assign(read.begin(), read.end());
    const auto step = equilibrium_.solve(read_, from_ + k, motion, share, run_out_.of(from_ + k), row);
    if (++out.rounds == 1) {
      reading.error_um = step.rms_um;
      reading.allowed_um = std::max(options_.follow_um, options_.follow_fraction * step.size_um);
    }
    if (!(deflections_->largest_mm(at) <= removal::DeflectedEngager::kMaxDeflection_mm)) {
      out.reason = beyond_reach(row);
      start_from_before(k, row);
      break;
    }
    const double next_um = step.rms_um * std::max(kTrust, step.rms_um / before_um);
    out.settled = next_um < std::max(options_.settle_um, options_.settle_fraction * step.size_um);
    // A deflection that oscillates from reading to reading is damped by shorter steps.
    if (step.rms_um < (1 - kAsForeseen * share) * before_um)
      share = std::min(1.0, kLonger * share);
    else if (step.rms_um > kFall * before_um)
      share = std::max(kMinShare, kShorter * share);
    if (out.rounds >= kSwings) {
      share = std::min(share, kSwingShare / (out.rounds - kSwings + 1));
      if ((out.rounds - kSwings) % kSwingRounds == 0) {
        out.settled |= rests(row, step);
        swing_.assign(row.begin(), row.end());
      }
    }
    before_um = step.rms_um;
  }
  unsettled_in_a_row_ = out.settled ? 0 : unsettled_in_a_row_ + 1;
  if (k + 1 == count_) carve_to(count_);
  reading.settled = out.settled;
  reading.glance = engager_.glance_of(read_);
  pace_.was_read(from_ + k, stamps_[from_ + k], row, reading);
  auto& chips = chips_[readings_++ % chips_.size()];
  chips.clear();
  for (const removal::DeflectedChipSample& c : read_)
    if (c.chip.thickness_mm > 0) chips.push_back(c.chip);
  out.chips = chips;
  return out;
}

}  // namespace camber::deflection
