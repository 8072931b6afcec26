#pragma once
// Motion: moves the tip along lines and arcs, period by period of the control.
#include <cstddef>
#include <span>
#include <vector>

#include "base/geometry.h"
#include "copymill/path_piece.h"
#include "machine/machine.h"

namespace camber::copymill {

/// A speed limit at a distance along the path from here; 0: a stop there.
struct SpeedLimit {
  double distance_mm = 0, speed_mm_per_s = 0;
};

/// Motion in one tick, with even acceleration; where it ends at rest, with an even one to rest and then none.
struct TickMotion {
  double speed_mm_per_s = 0;  ///< speed at its end
  double distance_mm = 0;
};

/// Returns the motion as near to `wanted_mm_per_s` as the acceleration allows, such that every limit can still be kept
/// by braking with that acceleration. Limits that could be kept at the tick's beginning, by this rule, can be kept at
/// its end; of limits nearer than braking allows it makes the best.
TickMotion next_tick(double speed_mm_per_s, double wanted_mm_per_s, std::span<const SpeedLimit> ahead,
                     double acceleration_mm_per_s2, double tick_s);

/// Returns the way from a speed to rest, v^2 / (2 a).
double stopping_distance_mm(double speed_mm_per_s, double acceleration_mm_per_s2);

/// The greatest acceleration along a direction that asks no axis for more than its own; the path's own limit counts
/// too.
double acceleration_along(const machine::Machine& machine, const Vec3& direction);

/// Moves along a chain of pieces from rest to rest. Speeds are such that the axes' accelerations hold: half of the
/// smallest along the path, 0.7 of it in arcs, and 0.45 of it at corners, whose change of velocity a moving average
/// spreads over smoothing_s(). The average takes the tip off the path by kSmoothing_mm at most.
class FeedMotion {
 public:
  static constexpr double kSmoothing_mm = 0.002;

  explicit FeedMotion(const machine::Machine& machine);

  /// Requires a path that begins where the last one ended.
  void start(std::vector<PathPiece> path, bool rapid);
  /// Advances by one period. `wanted`: speed to aim for; a stop is 0. `ahead`: a further limit on the way, or none.
  void tick(double wanted_mm_per_s, const SpeedLimit& ahead);
  /// The path is done and the tip at rest.
  bool finished() const { return done() && settled_ >= window_.size(); }
  /// True if the tip is at rest, wherever that is.
  bool at_rest() const { return speed_ <= 0 && settled_ >= window_.size(); }
  const Vec3& tip() const { return tip_; }
  double speed_mm_per_s() const { return speed_; }
  double period_s() const { return period_s_; }
  double smoothing_s() const { return period_s_ * static_cast<double>(window_.size()); }
  double braking_mm_per_s2() const { return acceleration_; }
  double stopping_mm() const { return stopping_distance_mm(speed_, acceleration_); }
  /// Position along the path, before the moving average.
  std::size_t piece() const { return piece_; }
  double along_piece_mm() const { return along_; }
  const std::vector<PathPiece>& path() const { return path_; }
  /// Returns a place farther on and the direction there; the end of the path where it ends before.
  struct Ahead {
    Vec3 place, direction;
  };
  Ahead ahead(double distance_mm) const;
  /// Sets the tip down somewhere else, at rest.
  void place(const Vec3& tip);

 private:
  bool done() const { return piece_ >= path_.size(); }
  double corner_speed(const PathPiece& before, const PathPiece& behind) const;
  void plan();
  void advance(double mm);

  double period_s_;
  Vec3 velocity_limit_, rapid_limit_, acceleration_limit_;
  std::vector<Vec3> window_;  ///< ring buffer of the moving average
  std::size_t window_at_ = 0, settled_ = 0;
  std::vector<PathPiece> path_;
  std::vector<double> from_mm_;         ///< along the path to the beginning of each piece, and its length
  std::vector<double> entry_, within_;  ///< speed limits at the beginning of each piece and in it
  double acceleration_ = 0;
  bool rapid_ = false;
  std::size_t piece_ = 0;
  double along_ = 0, speed_ = 0;
  Vec3 ideal_ = Vec3::Zero(), tip_ = Vec3::Zero();
  std::vector<SpeedLimit> limits_;
};

}  // namespace camber::copymill
