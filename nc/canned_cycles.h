#pragma once
// Writes drilling, tapping, boring and pocket cycles out as moves.
#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

#include "base/geometry.h"
#include "nc/arcs.h"

namespace camber::nc {

/// One hole of a cycle. Heights are coordinates along the plane's normal (Z for G17), mm.
struct CycleHole {
  int g = 81;  ///< 73, 74, 76, 81..89
  Vec3 from_mm = Vec3::Zero();
  Vec3 place_mm = Vec3::Zero();      ///< the two coordinates in the plane count
  double retract_mm = 0;             ///< R
  double bottom_mm = 0;              ///< Z
  double clear_mm = 0;               ///< height at which the tool ends: the initial level (G98) or R (G99)
  double peck_mm = 0;                ///< Q of G73 and G83, or the first of pecks that become smaller; 0: in one go
  double peck_less_mm = 0;           ///< each peck is so much smaller than the one before it
  double least_peck_mm = 0;          ///< but no smaller than this
  double clear_every_mm = 0;         ///< G73: back to R whenever so much was drilled; 0: never
  double dwell_s = 0;                ///< P
  Vec3 shift_mm = Vec3::Zero();      ///< G76, G87: off the wall, with the spindle oriented
  double peck_clearance_mm = 0.254;  ///< G83: back to so far above the last depth; G73: retract of each peck
};

struct CycleStep {
  enum class Kind { rapid, feed, dwell } kind = Kind::rapid;
  Vec3 end_mm = Vec3::Zero();
  double dwell_s = 0;
};

/// The moves of one hole. First to the R level where the tool is below it, then over the hole, then down to R.
/// G81: feed in, rapid out. G82, G86, G89: dwell at the bottom. G73, G83: in pecks. G84, G74 (tapping), G85, G89:
/// out in feed. G76: bored, shifted off the wall, out in rapid, shifted back. G87: shifted, in rapid down to R, shifted
/// back, bored upwards to Z, shifted, out in rapid, shifted back. G88: as G86 (the retract by hand is taken as a
/// rapid). Steps without motion are omitted. Pecks are at most kMaxPecks.
std::vector<CycleStep> hole_steps(const CycleHole& hole, const PlaneAxes& axes);

inline constexpr double kMaxPecks = 100000;

/// Moves that all the drilling cycles of a program may make: tens of thousands of pecked holes. More are a slip of L or
/// Q.
inline constexpr std::size_t kMaxCycleMoves = 1'000'000;

// --- pockets

/// A pocket in program coordinates: rectangular with rounded corners, a slot, or round. Heights are coordinates along
/// the plane's normal.
struct PocketCycle {
  bool round = false;
  Vec3 middle_mm = Vec3::Zero();
  double angle_rad = 0;        ///< of the first side
  double half_mm[2] = {0, 0};  ///< ways of the cutter's centre from the middle to the finished walls
  double corner_mm = 0;        ///< radius of its way round the corners there
  double sideways_mm = 0;      ///< at most, from ring to ring
  double sense = 1;            ///< of the rings: 1 counter-clockwise
  double surface_mm = 0, bottom_mm = 0, clearance_mm = 0;
  double step_mm = 0;                   ///< depth of a cut
  double side_mm = 0, floor_mm = 0;     ///< allowances that roughing leaves
  double finishing_step_mm = 0;         ///< depth of a cut along the walls; 0: all at once
  bool roughs = true, finishes = true;  ///< walls and floor are finished where they have an allowance
  double feed_mm_per_s = 0, plunge_mm_per_s = 0, finishing_mm_per_s = 0;

  double least_mm() const { return round ? half_mm[0] : std::min(half_mm[0], half_mm[1]); }
};

/// Receives the moves. A line of infinite feed is a rapid; a circle begins where the last move has ended.
struct PocketMoves {
  std::function<void(const Vec3& end_mm, double feed_mm_per_s)> line;
  std::function<void(const Vec3& centre_mm, double sweep_rad, double feed_mm_per_s)> circle;
};

/// Rings in one height, from the middle outwards: the cutter's centre `from_mm` off the finished walls' way, measured
/// inwards, to `to_mm`. Returns false where they are more than kMaxPecks.
bool mill_pocket_level(const PocketCycle& pocket, const PlaneAxes& axes, double height_mm, double from_mm, double to_mm,
                       const PocketMoves& moves);

/// Roughing from the middle outwards in depths, up to the allowances; then the walls in depths, and the floor from the
/// middle outwards. On a real control the ways from ring to ring, those on and off the walls and the plunge along a
/// helix or to and fro differ. `from_mm`: where the tool stands. Returns false where rings or depths are more than
/// kMaxPecks.
bool mill_pocket(const PocketCycle& pocket, const PlaneAxes& axes, const Vec3& from_mm, const PocketMoves& moves);

}  // namespace camber::nc
