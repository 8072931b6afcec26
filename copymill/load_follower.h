#pragma once
// Load follower: reads the load of the cut, tooth passing by tooth passing, and sets feed and depths.
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "base/geometry.h"
#include "machine/copy_operations.h"
#include "machine/job_file.h"
#include "removal/engagement.h"
#include "removal/stock.h"
#include "removal/tool_path.h"
#include "simulate/cut.h"
#include "simulate/load_probe.h"

namespace camber::copymill {

// Load rule: lets feed and depths follow the load of a cut, first the feed, then the radial, then the axial depth.
//
// Overview. The caller reports every tooth passing by feel() and takes feed and depths from conditions() at every tick;
// ahead of the tool it asks the model for the load at a place and passes the result on. The load may be the lateral
// force, the torque, the power or the deflection; LoadBand has its limit and all numbers of the rule, as fractions of
// the limit or of the nominal feed and depths. The rule has no model of its own: it assumes that
// the load is proportional to the feed. Edge forces make it less than proportional; the next passing shows the rest.
//
// - Every tooth passing has its load and the feed at which it was cut. The load at the feed now commanded is taken as
//   proportional to the feed, and of the passings of the last turn the greatest counts: teeth differ.
// - Over the limit the feed falls at once, in proportion, to LoadBand::aim of the limit, down to the lowest feed.
// - Below LoadBand::up_below of the limit it rises by a step a turn, up to the highest feed.
// - Over the limit at the lowest feed for some passings, the radial depth falls, and when it is at its lowest the axial
//   one: the tool has to leave the cut and go on with new depths. The feed waits for that at its lowest.
// - Where for some turns the next greater depth would keep the limit at the nominal feed, it rises again: the axial
//   depth first, then the radial one, for rows and levels to come.
// - In air nothing is learned: after a turn of it the feed is the nominal one.
//
// What is felt over what the model expects is the hardness that the rule goes by when it looks ahead: it rises at once,
// and falls slowly.

/// The ratio of felt to expected load, remembered by the place of the chips in X and Y, whatever their height: a
/// loop beside one that has been cut, or the level below, need not find out again that a part of the material is hard.
/// The ratio is that of mean torques, a sum in which every chip counts for itself. Lateral forces of chips on both
/// sides of a border may cancel, and where some of them grow by 1.4 their sum may by 1.9.
class FeltHardness {
 public:
  explicit FeltHardness(double cell_mm) : cell_mm_(cell_mm) {}

  /// Takes a tooth passing. The value of a cell rises at once, and falls by a fifth of the difference.
  void feel(const Vec3& chips, double ratio);
  /// The greatest in the cell of a place and those beside it; 1 at least.
  double at(const Vec3& chips) const;

 private:
  std::uint64_t cell(const Vec3& place, int di, int dj) const;

  double cell_mm_;
  std::unordered_map<std::uint64_t, float> ratio_;
};

enum class LoadKind : std::uint8_t { force, torque, power, deflection };
/// Quantity that is limited: lateral force in N, greatest torque of a passing in N mm, power in W, deflection in mm.
double load_of(const simulate::StampLoad& load, LoadKind kind, double spindle_rpm);

struct LoadBand {
  double limit = 0;                      ///< limit of the load, in its unit
  int teeth = 1;                         ///< tooth passings a turn
  double up_below = 0.80, aim = 0.90;    ///< fractions of the limit
  double up_step = 0.10;                 ///< fraction of the nominal feed
  double lowest = 0.50, highest = 1.50;  ///< fraction of the nominal feed
  double max_feed_mm_per_s = 1e9;        ///< bound of machine and operation; wins over `highest`
  int turns_at_lowest = 2;               ///< turns over the limit at the lowest feed before a depth falls
  int turns_of_room = 10;                ///< turns with room for a greater depth before it rises
  double depth_step = 0.80;              ///< a depth falls to this share of itself, or lower in proportion to the load
  double lowest_depth = 0.25;            ///< fraction of the nominal depths
};

struct LoadConditions {
  double feed_mm_per_s = 0, radial_mm = 0, axial_mm = 0;
};

/// A tooth passing.
struct Felt {
  double t_s = 0;
  Vec3 place_mm = Vec3::Zero();
  double load = 0;           ///< felt load; 0: in air
  double expected = 0;       ///< load that the model expects of the same passing
  double feed_mm_per_s = 0;  ///< feed at which it was cut
};

enum class Quantity : std::uint8_t { feed, radial_depth, axial_depth, radial_engagement };
enum class Cause : std::uint8_t {
  over_limit,
  below_band,
  over_at_lowest_feed,
  room_for_depth,
  in_air,
  ahead,
  clear_ahead,
  // Of the radial engagement, where the cutter's full width would be in the cut (copymill/slotting.h).
  trochoids_asked_for,
  full_cut_over_limit,
  full_cut_within_limit,
  slot_too_narrow
};
std::string_view name_of(Quantity quantity);
std::string_view text_of(Cause cause);

struct Change {
  double t_s = 0;
  Vec3 place_mm = Vec3::Zero();
  Quantity what = Quantity::feed;
  double from = 0, to = 0;  ///< mm/s, mm
  Cause cause = Cause::over_limit;
  double share = 0;  ///< load over limit, at the feed commanded before
};

class LoadRule {
 public:
  static constexpr double kRemembered = 1.06;

  LoadRule(const LoadBand& band, const LoadConditions& nominal);

  void feel(const Felt& passing);
  /// Feed for the next tick; radial depth for the next row, axial depth for the next level.
  const LoadConditions& conditions() const { return now_; }
  /// True after a depth has fallen: the tool has to leave the cut and go on with conditions(). Until replanned().
  bool replan() const { return replan_; }
  void replanned();

  /// The feed that keeps the limit at a place ahead, from what the model tells of it at two feeds, `feed` and half of
  /// it; no lower than the lowest feed. `hardness_there`: what has been felt near that place over what was expected.
  /// It may lie a little farther on: with it the load may be over the limit by kRemembered. The present hardness()
  /// counts in full.
  double feed_ahead(double load, double load_at_half, double feed_mm_per_s, double hardness_there = 1) const;
  bool at_highest_feed() const { return now_.feed_mm_per_s >= highest_feed(); }
  /// Returns the ratio of felt to expected load.
  double hardness() const { return hardness_; }
  /// Notes that a place ahead allows no more than this feed; infinite: nothing ahead binds. For the log: keeping it is
  /// up to the motion (copymill/runner.h).
  void note_ahead(double t_s, const Vec3& place_mm, double feed_mm_per_s);

  const std::vector<Change>& log() const { return log_; }

 private:
  struct Passing {
    double share;  ///< load over limit
    double feed_mm_per_s;
  };
  double highest_feed() const;
  double lowest_feed() const { return band_.lowest * nominal_.feed_mm_per_s; }
  double share_at(double feed_mm_per_s) const;
  void in_air(const Felt& passing);
  void learn_hardness(const Felt& passing);
  void follow_feed(const Felt& passing);
  void follow_depths(const Felt& passing);
  bool lower_a_depth(const Felt& passing, double share);
  bool raise_a_depth(const Felt& passing, double share_at_nominal);
  void set(double LoadConditions::*what, double to, Cause cause, const Felt& passing, double share);

  LoadBand band_;
  LoadConditions nominal_, now_;
  std::deque<Passing> turn_;                                           ///< the last passings in material
  int air_ = 0, since_step_ = 0, over_at_lowest_ = 0, with_room_ = 0;  ///< passings
  double hardness_ = 1;
  bool replan_ = false, bound_ahead_ = false;
  std::vector<Change> log_;
};

/// A place where tooth passings take more than LoadFigures::kOver of the target.
struct OverTarget {
  double t_s = 0;
  Vec3 place_mm = Vec3::Zero();  ///< tip at the greatest force
  double force_N = 0;            ///< greatest force
  std::size_t passings = 0;
};

/// Figures of how well an operation's load kept to its target.
struct LoadFigures {
  static constexpr double kOver = 1.1;  ///< fraction of the target: places with more are named
  double target_N = 0;                  ///< 0: none, feed and depths stay as they are
  double max_N = 0;
  std::size_t passings = 0;          ///< passings that cut
  std::size_t counted = 0;           ///< passings at a free feed: not the lowest, the highest or a corner's
  std::size_t within = 0;            ///< number of the counted ones with 80 to 105 % of the target
  std::size_t over = 0;              ///< number of all that cut with more than 120 %
  std::vector<OverTarget> places{};  ///< in order of time
};

/// One operation: the probe that cuts the stock, and the rule where the operation has a target.
class LoadFollower {
 public:
  /// Without `loads`, and without a target, passings have a load of 0 and the stock is cut by flush().
  LoadFollower(const machine::Job& job, const machine::CopyOperation& operation, removal::Stock& stock,
               const removal::TipBox& tips, const simulate::ForceRegions& regions, std::int32_t first_id, bool loads);

  /// The feed to command: that of the rule, or less where more load lies ahead. A multiple of a fiftieth of the
  /// nominal feed, so that few F words are needed.
  double feed_mm_per_s() const { return feed_; }
  double radial_mm() const;
  double axial_mm() const;
  bool replan() const { return rule_ && rule_->replan(); }
  void replanned() { rule_->replanned(); }

  /// The load that the model expects of a cut at a place at the lowest feed, with what is felt over it, as a share of
  /// the target. `direction`: of length 1. Nothing without a target.
  std::optional<double> share_at_lowest_feed(const Vec3& tip, const Vec3& direction);

  /// A place that the tool reaches soon.
  struct Ahead {
    Vec3 place, direction;         ///< tip and its direction there
    double way_mm = 0;             ///< along the path to it, as far as braking needs or farther
    double braking_mm_per_s2 = 1;  ///< deceleration along the path
  };
  void look_ahead(double t_s, const Ahead& ahead);
  /// Calls removal::StepEngager::approach.
  void approach(const Vec3& tip, int most) {
    if (probe_) probe_->approach(tip, most);
  }
  /// Cuts one tooth passing. `commanded`: the feed it was to be cut at. Returns the lateral force.
  double pass(const removal::Stamp& stamp, double commanded_mm_per_s);

  double flush();
  std::int32_t next_id() const;
  const LoadFigures& figures() const { return figures_; }
  std::vector<Change> changes() const { return rule_ ? rule_->log() : std::vector<Change>{}; }

 private:
  void choose_feed();
  double allowed_mm_per_s() const;
  void wait(const removal::Stamp& stamp);
  void note_over(const removal::Stamp& stamp, double force);
  void count(double force_N, double actual_mm_per_s, double commanded_mm_per_s);

  const machine::CopyOperation& operation_;
  double passing_s_;
  std::optional<simulate::LoadProbe> probe_;  ///< not given: waiting_ is swept by flush()
  removal::Stock& stock_;
  removal::CutterShape shape_;
  std::int32_t first_id_;
  std::vector<removal::Stamp> waiting_;
  double apart_mm_;  ///< distance of waiting stamps
  std::optional<LoadRule> rule_;
  FeltHardness felt_;
  LoadBand band_;
  double feed_;
  struct Bound {
    double at_mm, feed_mm_per_s;  ///< along the path, and no faster there
  };
  std::vector<Bound> bounds_;  ///< feed bounds at places that the tool has not reached
  double gone_mm_ = 0, passing_mm_ = 0, braking_mm_per_s2_ = 1;
  LoadFigures figures_;
  double last_over_s_ = 0;
};

}  // namespace camber::copymill
