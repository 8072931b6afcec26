#pragma once
// Load follower: reads the load of the cut, tooth passing by tooth passing, and sets feed and depths.
#include <optional>
#include <vector>

#include "copymill/load_rule.h"
#include "machine/copy_operations.h"
#include "machine/job_file.h"
#include "removal/engagement.h"
#include "removal/stock.h"
#include "removal/tool_path.h"
#include "simulate/load_probe.h"

namespace camber::copymill {

/// A place where tooth passings take more than LoadFigures::kOver of the target.
struct OverTarget {
  double t_s = 0;
  Vec3 place_mm = Vec3::Zero();  ///< tip at the greatest force
  double force_N = 0;            ///< greatest
  std::size_t passings = 0;
};

/// Figures of how well an operation's load kept to its target.
struct LoadFigures {
  static constexpr double kOver = 1.1;  ///< fraction of the target: places with more are named
  double target_N = 0;                  ///< 0: none, feed and depths stay as they are
  double max_N = 0;
  std::size_t passings = 0;          ///< passings that cut
  std::size_t counted = 0;           ///< those at a free feed: not the lowest, the highest or a corner's
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
