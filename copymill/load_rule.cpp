#include "copymill/load_follower.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace camber::copymill {

std::uint64_t FeltHardness::cell(const Vec3& place, int di, int dj) const {
  const auto index = [&](double v, int shift) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(std::lround(v / cell_mm_) + shift));
  };
  return index(place.x(), di) << 32 | index(place.y(), dj);
}

void FeltHardness::feel(const Vec3& chips, double ratio) {
  constexpr double kForget = 0.2;
  const auto [found, first] = ratio_.try_emplace(cell(chips, 0, 0), static_cast<float>(ratio));
  if (first) return;
  const double before = found->second;
  found->second = static_cast<float>(ratio > before ? ratio : before + kForget * (ratio - before));
}

double FeltHardness::at(const Vec3& chips) const {
  double out = 1;
  for (int di = -1; di <= 1; ++di)
    for (int dj = -1; dj <= 1; ++dj)
      if (const auto found = ratio_.find(cell(chips, di, dj)); found != ratio_.end())
        out = std::max(out, static_cast<double>(found->second));
  return out;
}

namespace {

/// Factor on the lowest feed: below it a passing counts as cut at the lowest.
constexpr double kAtLowest = 1.02;

/// A share by which the hardness that is felt falls towards what the last passing told. It rises at once.
constexpr double kForget = 0.05;

/// Loads below this share of the limit tell little about hardness: edges hardly cut.
constexpr double kTellsHardness = 0.1;

/// A depth rises only where the load is expected below this share of the limit.
constexpr double kRoom = 0.95;

/// Depths, mm, and feeds, mm/s, that differ by less are the same.
constexpr double kSame = 1e-9;

}  // namespace

double load_of(const simulate::StampLoad& load, LoadKind kind, double spindle_rpm) {
  switch (kind) {
    case LoadKind::force:
      return load.lateral_max_N;
    case LoadKind::torque:
      return load.torque_max_Nmm;
    case LoadKind::power:
      return simulate::power_W(load.torque_mean_Nmm, spindle_rpm);
    case LoadKind::deflection:
      return load.deflection_max_mm;
  }
  return 0;
}

std::string_view name_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::feed:
      return "feed";
    case Quantity::radial_depth:
      return "radial depth";
    case Quantity::axial_depth:
      return "axial depth";
    case Quantity::radial_engagement:
      return "radial engagement";
  }
  return "";
}

std::string_view text_of(Cause cause) {
  switch (cause) {
    case Cause::over_limit:
      return "load over the limit";
    case Cause::below_band:
      return "load below the band";
    case Cause::over_at_lowest_feed:
      return "load over the limit at the lowest feed";
    case Cause::room_for_depth:
      return "load allows more depth";
    case Cause::in_air:
      return "in air";
    case Cause::ahead:
      return "more load ahead";
    case Cause::clear_ahead:
      return "nothing ahead binds";
    case Cause::trochoids_asked_for:
      return "trochoids instead of a full cut";
    case Cause::full_cut_over_limit:
      return "trochoids; a full cut is over the limit at the lowest feed and depth";
    case Cause::full_cut_within_limit:
      return "full cut; feed and depth can hold the limit";
    case Cause::slot_too_narrow:
      return "full cut; the slot is too narrow for trochoids";
  }
  return "";
}

LoadRule::LoadRule(const LoadBand& band, const LoadConditions& nominal)
    : band_(band), nominal_(nominal), now_(nominal) {
  assert(band.limit > 0 && band.teeth > 0 && nominal.feed_mm_per_s > 0);
  assert(band.up_below <= band.aim && band.aim <= 1 && band.lowest <= 1 && band.highest >= 1);
  now_.feed_mm_per_s = std::min(nominal.feed_mm_per_s, highest_feed());
}

double LoadRule::highest_feed() const {
  return std::max(lowest_feed(), std::min(band_.highest * nominal_.feed_mm_per_s, band_.max_feed_mm_per_s));
}

/// Returns the greatest load of the last turn's passings at a feed, over the limit.
double LoadRule::share_at(double feed_mm_per_s) const {
  double greatest = 0;
  for (const Passing& p : turn_) greatest = std::max(greatest, p.share * feed_mm_per_s / p.feed_mm_per_s);
  return greatest;
}

void LoadRule::set(double LoadConditions::*what, double to, Cause cause, const Felt& passing, double share) {
  const Quantity quantity = what == &LoadConditions::feed_mm_per_s ? Quantity::feed
                            : what == &LoadConditions::radial_mm   ? Quantity::radial_depth
                                                                   : Quantity::axial_depth;
  if (std::abs(now_.*what - to) < kSame) return;
  log_.push_back({passing.t_s, passing.place_mm, quantity, now_.*what, to, cause, share});
  now_.*what = to;
}

void LoadRule::feel(const Felt& passing) {
  if (!(passing.load > 0) || !(passing.feed_mm_per_s > 0)) return in_air(passing);
  air_ = 0;
  turn_.push_back({passing.load / band_.limit, passing.feed_mm_per_s});
  while (turn_.size() > static_cast<std::size_t>(band_.teeth)) turn_.pop_front();
  learn_hardness(passing);
  follow_feed(passing);
  follow_depths(passing);
}

void LoadRule::in_air(const Felt& passing) {
  if (++air_ < band_.teeth) return;
  turn_.clear();
  since_step_ = over_at_lowest_ = 0;
  if (!replan_)
    set(&LoadConditions::feed_mm_per_s, std::min(nominal_.feed_mm_per_s, highest_feed()), Cause::in_air, passing, 0);
}

void LoadRule::learn_hardness(const Felt& passing) {
  if (!(passing.expected > kTellsHardness * band_.limit)) return;
  const double felt = passing.load / passing.expected;
  hardness_ = felt > hardness_ ? felt : hardness_ + kForget * (felt - hardness_);
}

void LoadRule::follow_feed(const Felt& passing) {
  ++since_step_;
  const double share = share_at(now_.feed_mm_per_s);
  if (share > 1) {
    const double to = std::max(lowest_feed(), now_.feed_mm_per_s * band_.aim / share);
    set(&LoadConditions::feed_mm_per_s, to, Cause::over_limit, passing, share);
    since_step_ = 0;
  } else if (share < band_.up_below && since_step_ >= band_.teeth && !replan_) {
    const double step = band_.up_step * nominal_.feed_mm_per_s;
    // No step leads over the aim.
    const double to = std::min({now_.feed_mm_per_s + step, highest_feed(), now_.feed_mm_per_s * band_.aim / share});
    set(&LoadConditions::feed_mm_per_s, to, Cause::below_band, passing, share);
    since_step_ = 0;
  }
}

void LoadRule::follow_depths(const Felt& passing) {
  if (replan_) return;
  const bool lowest = passing.feed_mm_per_s <= kAtLowest * lowest_feed();
  over_at_lowest_ = lowest && passing.load > band_.limit ? over_at_lowest_ + 1 : 0;
  if (over_at_lowest_ >= band_.turns_at_lowest * band_.teeth) {
    over_at_lowest_ = 0;
    replan_ = lower_a_depth(passing, share_at(now_.feed_mm_per_s));
  }
  const double at_nominal = share_at(nominal_.feed_mm_per_s);
  with_room_ = at_nominal < kRoom ? with_room_ + 1 : 0;
  if (with_room_ >= band_.turns_of_room * band_.teeth && raise_a_depth(passing, at_nominal)) with_room_ = 0;
}

bool LoadRule::lower_a_depth(const Felt& passing, double share) {
  for (auto what : {&LoadConditions::radial_mm, &LoadConditions::axial_mm}) {
    const double lowest = band_.lowest_depth * nominal_.*what;
    if (now_.*what <= lowest + kSame) continue;
    const double to = std::max(lowest, now_.*what * std::min(band_.depth_step, band_.aim / share));
    set(what, to, Cause::over_at_lowest_feed, passing, share);
    return true;
  }
  return false;
}

bool LoadRule::raise_a_depth(const Felt& passing, double share) {
  for (auto what : {&LoadConditions::axial_mm, &LoadConditions::radial_mm}) {
    const double to = std::min(nominal_.*what, now_.*what / band_.depth_step);
    if (to <= now_.*what + kSame) continue;
    if (share * to / now_.*what > kRoom) return false;
    set(what, to, Cause::room_for_depth, passing, share);
    return true;
  }
  return false;
}

void LoadRule::replanned() {
  replan_ = false;
  turn_.clear();
  since_step_ = over_at_lowest_ = with_room_ = 0;
}

double LoadRule::feed_ahead(double load, double load_at_half, double feed_mm_per_s, double hardness_there) const {
  const double limit = band_.limit / std::max({1.0, hardness_, hardness_there / kRemembered});
  const double highest = highest_feed();
  if (!(load > 0)) return highest;
  const double per_feed = std::max(0.0, load - load_at_half) / (0.5 * feed_mm_per_s);
  const double without_feed = load - per_feed * feed_mm_per_s;
  if (without_feed >= limit) return lowest_feed();
  if (per_feed <= 0) return highest;
  return std::clamp((limit - without_feed) / per_feed, lowest_feed(), highest);
}

void LoadRule::note_ahead(double t_s, const Vec3& place_mm, double feed_mm_per_s) {
  const bool binds = feed_mm_per_s < now_.feed_mm_per_s - kSame;
  if (binds == bound_ahead_) return;
  bound_ahead_ = binds;
  const double own = now_.feed_mm_per_s;
  log_.push_back({t_s, place_mm, Quantity::feed, binds ? own : std::min(own, feed_mm_per_s),
                  binds ? feed_mm_per_s : own, binds ? Cause::ahead : Cause::clear_ahead, 0});
}

}  // namespace camber::copymill
