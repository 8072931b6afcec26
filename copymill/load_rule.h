#pragma once
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
#include <cstdint>
#include <deque>
#include <span>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "base/geometry.h"
#include "simulate/cut.h"

namespace camber::copymill {

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
/// N (lateral), N mm (greatest of a passing), W, mm.
double load_of(const simulate::StampLoad& load, LoadKind kind, double spindle_rpm);

struct LoadBand {
  double limit = 0;                      ///< limit of the load, in its unit
  int teeth = 1;                         ///< tooth passings a turn
  double up_below = 0.80, aim = 0.90;    ///< fractions of the limit
  double up_step = 0.10;                 ///< fraction of the nominal feed
  double lowest = 0.50, highest = 1.50;  ///< fraction of the nominal feed
  double max_feed_mm_per_s = 1e9;        ///< bound of machine and operation; wins over `highest`
  int turns_at_lowest = 2;               ///< over the limit at the lowest feed before a depth falls
  int turns_of_room = 10;                ///< before a depth rises
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
  /// up to the motion (copymill/feed_motion.h).
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

}  // namespace camber::copymill
