#pragma once
// Runner: runs the tool along passes in ticks, cuts every tooth passing, follows the load, and writes the program.
#include <chrono>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/geometry.h"
#include "copymill/clear_height.h"
#include "copymill/copy_milling.h"
#include "copymill/load_follower.h"
#include "copymill/part_check.h"
#include "copymill/path_piece.h"
#include "copymill/standing.h"
#include "machine/machine_model.h"
#include "removal/cutter.h"
#include "removal/tool_path.h"

namespace camber::copymill {

// Motion: moves the tip along lines and arcs, period by period of the control.

/// A speed limit at a distance along the path from here; a speed of 0 is a stop.
struct SpeedLimit {
  double distance_mm = 0, speed_mm_per_s = 0;
};

/// Motion in one tick, with even acceleration; where it ends at rest, with an even one to rest and then none.
struct TickMotion {
  double speed_mm_per_s = 0;  ///< speed at its end
  double distance_mm = 0;
};

/// Returns the motion as near to `wanted_mm_per_s` as the acceleration allows, such that every limit can still be kept
/// by braking with that acceleration. Limits that could be kept at the beginning of the tick can be kept at its end;
/// for limits nearer than braking allows it brakes as far as possible.
TickMotion next_tick(double speed_mm_per_s, double wanted_mm_per_s, std::span<const SpeedLimit> ahead,
                     double acceleration_mm_per_s2, double tick_s);

/// Returns the way from a speed to rest, v^2 / (2 a).
double stopping_distance_mm(double speed_mm_per_s, double acceleration_mm_per_s2);

/// Returns the greatest acceleration along a direction within the limits of the axes and of the path.
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
  /// Returns whether the path is done and the tip at rest.
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
  /// Places the tip somewhere else, at rest.
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
  std::vector<double> from_mm_;         ///< length along the path at the beginning of each piece, and of the whole path
  std::vector<double> entry_, within_;  ///< speed limits at the beginning of each piece and in it
  double acceleration_ = 0;
  bool rapid_ = false;
  std::size_t piece_ = 0;
  double along_ = 0, speed_ = 0;
  Vec3 ideal_ = Vec3::Zero(), tip_ = Vec3::Zero();
  std::vector<SpeedLimit> limits_;
};

/// An operation with its tool.
struct OperationCut {
  const machine::CopyOperation& operation;
  const machine::Tool& tool;
  removal::CutterShape shape;
};

class Runner {
 public:
  enum class Ended {
    done,
    stopped,  ///< ended by CopyOptions::stop_after_s
    replan    ///< a depth was lowered: the tool stands in the cut and waits for other passes
  };

  Runner(const machine::Job& job, const CopyOptions& options, removal::Stock& stock);

  /// Begins an operation: its tool is at the safe height. `depth`: judges the path; none for holes. `lowest_mm`: lowest
  /// height of the tip.
  void begin(const OperationCut& cut, Standing& standing, double safe_z_mm, PathDepth* depth, double lowest_mm);
  /// Ends an operation and writes its cuts to the stock.
  void end();

  /// Moves the tool straight in rapid through air.
  Ended rapid(const Vec3& to);
  /// Cuts along points from where the tool is, at a fraction of the feed. Does nothing if the tool is there already.
  Ended cut(const std::vector<Vec3>& points, bool closed, double feed_share = 1);

  /// Cuts along lines and arcs that begin where the tool is.
  Ended follow(std::vector<PathPiece> path);

  /// Position of the tip; not given at the start of an operation.
  const std::optional<Vec3>& at() const { return at_; }
  double safe_z_mm() const { return safe_z_; }
  bool stopped() const { return stopped_; }
  Ended ended() const;
  /// Radial depth of the next loops and rows, axial depth of the next level.
  double radial_mm() const { return follower_->radial_mm(); }
  double axial_mm() const { return follower_->axial_mm(); }
  /// Tells the follower that other passes follow.
  void replanned() { follower_->replanned(); }
  /// Returns the load of a level cut at a place at the lowest feed, as the model expects it times the hardness felt, as
  /// a fraction of the target; nothing where the operation has no target.
  std::optional<double> share_at_lowest_feed(const Vec3& tip, const Vec2& direction);
  /// Logs how a full cut was made or avoided, at the present time.
  void note_slot(const Vec3& tip, double from_mm, double to_mm, Cause cause, double share);
  /// Clear height after all operations so far.
  const ClearHeight& clear_height() const { return clear_height_; }
  double increment_mm() const { return piece_options_.increment_mm; }

  OperationSummary& summary() { return summary_; }
  /// Completes the text and fills in what concerns the whole run. Call once.
  void finish(CopyResult& result);

 private:
  Ended run(std::vector<PathPiece> path, bool rapid, double feed_share);
  void tick(bool rapid, double feed_share, bool halted);
  /// Cuts the tooth passings of a tick. Returns true if there was one.
  bool stamp_until(double t_s, const Vec3& before, const Vec3& now);
  void look_ahead();
  /// Read stock before a tooth passing needs it: around the tool at rest, and some of what it reaches soon.
  void read_stock_here();
  void read_stock_ahead();
  void stamp_at(double t_s, const Vec3& tip);
  void command(double feed_mm_per_s);
  void lower_standing(const Vec3& tip);
  void write_cut(const PathPiece& piece, double feed_mm_per_s);
  /// Writes the path up to where the motion is.
  void write_to(std::size_t piece, double along_mm, double feed_mm_per_s);
  double feed_mm_per_s(double feed_share) const { return feed_share * follower_->feed_mm_per_s(); }

  const machine::Job& job_;
  const CopyOptions& options_;
  removal::Stock& stock_;
  FeedMotion motion_;
  const nc::Dialect& dialect_;
  std::unique_ptr<nc::ProgramWriter> writer_;
  PieceOptions piece_options_;
  ClearHeight clear_height_;
  std::optional<OperationCut> cut_;
  Standing* standing_ = nullptr;
  PathDepth* depth_ = nullptr;
  OperationSummary summary_;
  std::vector<Change> notes_;  ///< changes of the operation, beside the follower's
  std::optional<Vec3> at_;
  double safe_z_ = 0;
  double t_s_ = 0;
  std::size_t ticks_ = 0;
  std::chrono::nanoseconds tick_time_{0}, longest_tick_{0};
  bool stopped_ = false;

  // Since the last write.
  std::size_t written_piece_ = 0;
  double written_mm_ = 0;

  std::optional<LoadFollower> follower_;
  double load_N_ = 0, commanded_ = 0, written_feed_ = 0;
  std::int32_t first_id_ = 0;
  double next_passing_s_ = 0;
  bool first_stamp_ = true, look_due_ = false;
  Vec3 last_stamp_ = Vec3::Zero(), last_lowered_ = Vec3::Zero();
  double removed_mm3_ = 0;
};

}  // namespace camber::copymill
