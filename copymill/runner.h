#pragma once
// Runner: runs the tool along passes in ticks, cuts every tooth passing, follows the load, and writes the program.
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "copymill/clear_height.h"
#include "copymill/copy_milling.h"
#include "copymill/feed_motion.h"
#include "copymill/load_follower.h"
#include "copymill/part_check.h"
#include "copymill/standing.h"
#include "removal/cutter.h"
#include "removal/tool_path.h"

namespace camber::copymill {

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
    replan    ///< a depth has fallen: the tool stands in the cut and waits for other passes
  };

  Runner(const machine::Job& job, const CopyOptions& options, removal::Stock& stock);

  /// The tool of an operation stands at the safe height from here on.
  /// `depth`: judges the path; none for holes. `lowest_mm`: the tip goes no deeper.
  void begin(const OperationCut& cut, Standing& standing, double safe_z_mm, PathDepth* depth, double lowest_mm);
  /// Writes what was cut to the stock.
  void end();

  /// Straight, in rapid, through air.
  Ended rapid(const Vec3& to);
  /// Along points from where the tool is, at a share of the feed. Nothing is done where it is there already.
  Ended cut(const std::vector<Vec3>& points, bool closed, double feed_share = 1);

  /// Along lines and arcs that begin where the tool is.
  Ended follow(std::vector<PathPiece> path);

  /// Not given at the start of an operation.
  const std::optional<Vec3>& at() const { return at_; }
  double safe_z_mm() const { return safe_z_; }
  bool stopped() const { return stopped_; }
  Ended ended() const;
  /// Radial depth of the next loops and rows, axial depth of the next level.
  double radial_mm() const { return follower_->radial_mm(); }
  double axial_mm() const { return follower_->axial_mm(); }
  /// Other passes follow.
  void replanned() { follower_->replanned(); }
  /// The load that the model expects of a level cut at a place at the lowest feed, with what is felt over it, as a
  /// share of the target; nothing where the operation has none.
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
  /// Tooth passings of a tick; true if there was one.
  bool stamp_until(double t_s, const Vec3& before, const Vec3& now);
  void look_ahead();
  /// Before a tooth passing needs it: the stock around the tool at rest, and some of what it reaches soon.
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
