#include "copymill/load_follower.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "removal/engagement.h"
#include "simulate/predict_path.h"

namespace camber::copymill {
namespace {

/// Coarser than a prediction's: a tick has half a millisecond. 2 degrees lose about a hundredth of a peak.
constexpr double kEnvelopeStep_mm = 0.2, kRotationStep_rad = 2 * kPi / 180;
constexpr double kFeedSteps = 50;               ///< feeds are whole fractions 1 / kFeedSteps of the nominal feed
constexpr double kUpBelow = 0.88, kAim = 0.94;  ///< fractions of the target
constexpr double kUpStep = 0.5;                 ///< fraction of the nominal feed; no step leads over the aim
constexpr double kFromBand = 0.80, kToBand = 1.05, kNever = 1.2;  // of the target
constexpr double kHeldBack = 0.9;                                 ///< fraction of the commanded feed
constexpr double kCellShare = 0.1;      ///< fraction of the radius: width of the columns that remember hardness
constexpr double kTellsHardness = 0.1;  ///< fraction of the target: a smaller expected load says nothing
constexpr double kCutting = 0.01;       ///< fraction of the target: less counts as air

constexpr double kRidge_mm = 0.0003;  ///< between stamps that are swept

/// Stamps so far apart leave ridges of kRidge_mm.
double stamps_apart_mm(const machine::Tool& tool) { return std::sqrt(4 * tool.diameter_mm * kRidge_mm); }

simulate::LoadProbeOptions probe_options(const machine::Job& job, const machine::CopyOperation& operation,
                                         const simulate::ForceRegions& regions, std::int32_t first_id) {
  return {.envelope_step_mm = std::max(kEnvelopeStep_mm, simulate::envelope_step_mm(job, job.tools.at(operation.tool))),
          .rotation_step_rad = std::max(kRotationStep_rad, job.simulation.rotation_step_rad),
          .first_id = first_id,
          .drilling = operation.mode == machine::CopyMode::drilling,
          .deflections = false,
          .regions = regions.none() ? nullptr : &regions};
}

}  // namespace

LoadFollower::LoadFollower(const machine::Job& job, const machine::CopyOperation& operation, removal::Stock& stock,
                           const removal::TipBox& tips, const simulate::ForceRegions& regions, std::int32_t first_id,
                           bool loads)
    : operation_(operation),
      passing_s_(60 / (operation.spindle_rpm * job.tools.at(operation.tool).flutes)),
      stock_(stock),
      shape_(removal::shape_of(job.tools.at(operation.tool))),
      first_id_(first_id),
      apart_mm_(stamps_apart_mm(job.tools.at(operation.tool))),
      felt_(kCellShare * shape_.radius_mm),
      feed_(operation.feed_mm_per_s) {
  if (loads || operation.force_N)
    probe_.emplace(stock, job.tools.at(operation.tool), job.material, tips,
                   probe_options(job, operation, regions, first_id));
  if (!operation.force_N) return;
  band_.limit = figures_.target_N = *operation.force_N;
  band_.up_below = kUpBelow, band_.aim = kAim, band_.up_step = kUpStep;
  band_.teeth = job.tools.at(operation.tool).flutes;
  const double radial = std::max(operation.radial_depth_mm, 1e-3), axial = std::max(operation.axial_depth_mm, 1e-3);
  rule_.emplace(band_, LoadConditions{operation.feed_mm_per_s, radial, axial});
}

double LoadFollower::radial_mm() const { return rule_ ? rule_->conditions().radial_mm : operation_.radial_depth_mm; }
double LoadFollower::axial_mm() const { return rule_ ? rule_->conditions().axial_mm : operation_.axial_depth_mm; }

std::optional<double> LoadFollower::share_at_lowest_feed(const Vec3& tip, const Vec3& direction) {
  if (!rule_) return std::nullopt;
  removal::Stamp stamp;
  stamp.pose.tip_mm = tip;
  stamp.feed_per_tooth_mm = band_.lowest * operation_.feed_mm_per_s * passing_s_ * direction;
  const simulate::LoadProbe::Look look = probe_->look_at_two_feeds(stamp);
  const double load = load_of(look.at_feed, LoadKind::force, operation_.spindle_rpm);
  return load * std::max({1.0, rule_->hardness(), felt_.at(look.chips_at_mm)}) / band_.limit;
}

void LoadFollower::look_ahead(double t_s, const Ahead& ahead) {
  if (!rule_) return;
  const double feed = operation_.feed_mm_per_s;
  removal::Stamp stamp;
  stamp.t_s = t_s;
  stamp.pose.tip_mm = ahead.place;
  stamp.feed_per_tooth_mm = feed * passing_s_ * ahead.direction;
  const simulate::LoadProbe::Look look = probe_->look_at_two_feeds(stamp);
  const double load = load_of(look.at_feed, LoadKind::force, operation_.spindle_rpm),
               at_half = load_of(look.at_half, LoadKind::force, operation_.spindle_rpm);
  braking_mm_per_s2_ = ahead.braking_mm_per_s2;
  bounds_.push_back({gone_mm_ + ahead.way_mm, rule_->feed_ahead(load, at_half, feed, felt_.at(look.chips_at_mm))});
  rule_->note_ahead(t_s, ahead.place, allowed_mm_per_s());
  choose_feed();
}

/// The feed from which every bound ahead can be kept by braking, done a passing before it.
double LoadFollower::allowed_mm_per_s() const {
  double out = std::numeric_limits<double>::infinity();
  for (const Bound& bound : bounds_) {
    const double way = std::max(0.0, bound.at_mm - gone_mm_ - passing_mm_);
    out = std::min(out, std::sqrt(bound.feed_mm_per_s * bound.feed_mm_per_s + 2 * braking_mm_per_s2_ * way));
  }
  return out;
}

void LoadFollower::choose_feed() {
  const double step = operation_.feed_mm_per_s / kFeedSteps;
  const double wanted = std::min(rule_->conditions().feed_mm_per_s, allowed_mm_per_s());
  const double lowest = band_.lowest * operation_.feed_mm_per_s, highest = band_.highest * operation_.feed_mm_per_s;
  const double stepped = std::max(lowest, step * std::floor(wanted / step + 1e-6));
  // Up only where it is worth an F word, or to the highest.
  if (stepped < feed_ || stepped > feed_ + 1.5 * step || stepped > highest - 0.5 * step) feed_ = stepped;
}

double LoadFollower::pass(const removal::Stamp& stamp, double commanded) {
  if (!probe_) return wait(stamp), 0;
  const simulate::ProbedLoad& load = probe_->append({&stamp, 1}).front();
  const double force = load.felt.lateral_max_N;
  passing_mm_ = stamp.feed_per_tooth_mm.norm(), gone_mm_ += passing_mm_;
  if (stamp.first) bounds_.clear();
  std::erase_if(bounds_, [&](const Bound& bound) { return bound.at_mm <= gone_mm_; });
  const double actual = passing_mm_ / passing_s_;
  figures_.max_N = std::max(figures_.max_N, force);
  if (!rule_) return force;
  if (force > LoadFigures::kOver * figures_.target_N) note_over(stamp, force);
  if (load.expected.lateral_max_N > kTellsHardness * band_.limit)
    felt_.feel(load.chips_at_mm, load.felt.torque_mean_Nmm / load.expected.torque_mean_Nmm);
  // Slower than commanded at corners and where the tool sets off: the load there says little of the feed.
  if (actual < kHeldBack * commanded && force <= figures_.target_N) return force;
  rule_->feel({.t_s = stamp.t_s,
               .place_mm = stamp.pose.tip_mm,
               .load = force,
               .expected = load.expected.lateral_max_N,
               .feed_mm_per_s = actual});
  choose_feed();
  count(force, actual, commanded);
  return force;
}

/// A stamp in line with those before and behind it, and near them, is not needed.
void LoadFollower::wait(const removal::Stamp& stamp) {
  constexpr double kOffLine_mm = 1e-4;
  const std::size_t n = waiting_.size();
  if (n >= 2 && !stamp.first && !waiting_[n - 1].first) {
    const Vec3 &a = waiting_[n - 2].pose.tip_mm, &b = waiting_[n - 1].pose.tip_mm, whole = stamp.pose.tip_mm - a;
    const double way = whole.norm(), off = way > 0 ? (b - a).cross(whole).norm() / way : 0;
    if (way <= apart_mm_ && off <= kOffLine_mm && (b - a).dot(whole) >= 0) {
      waiting_.back() = stamp;
      return;
    }
  }
  waiting_.push_back(stamp);
}

double LoadFollower::flush() {
  if (probe_) return probe_->flush();
  const double removed = removal::sweep(stock_, shape_, waiting_, {.first_id = first_id_});
  first_id_ = next_id();
  waiting_.clear();
  return removed;
}

std::int32_t LoadFollower::next_id() const {
  return probe_ ? probe_->next_id() : first_id_ + static_cast<std::int32_t>(waiting_.size());
}

/// Passings of a few turns, or nearer to each other than a tenth of the radius, are one place.
void LoadFollower::note_over(const removal::Stamp& stamp, double force) {
  constexpr double kTurns = 3, kNear = 0.1;
  auto& places = figures_.places;
  const bool same = !places.empty() && (stamp.t_s - last_over_s_ < kTurns * band_.teeth * passing_s_ ||
                                        (stamp.pose.tip_mm - places.back().place_mm).norm() < kNear * shape_.radius_mm);
  if (!same) places.push_back({stamp.t_s, stamp.pose.tip_mm, force, 0});
  last_over_s_ = stamp.t_s;
  OverTarget& place = places.back();
  ++place.passings;
  if (force <= place.force_N) return;
  place.force_N = force;
  place.place_mm = stamp.pose.tip_mm;
}

void LoadFollower::count(double force, double actual, double commanded) {
  if (force < kCutting * figures_.target_N) return;
  ++figures_.passings;
  if (force > kNever * figures_.target_N) ++figures_.over;
  const double nominal = operation_.feed_mm_per_s, step = nominal / kFeedSteps;
  const bool bound = commanded >= band_.highest * nominal - step || commanded <= band_.lowest * nominal + 1e-9 ||
                     actual < 0.97 * commanded;
  if (bound) return;
  ++figures_.counted;
  if (force >= kFromBand * figures_.target_N && force <= kToBand * figures_.target_N) ++figures_.within;
}

}  // namespace camber::copymill
