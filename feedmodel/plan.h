#pragma once
// The whole path's plan: how fast each segment is entered, and how long it takes.
#include <cstdint>
#include <vector>

#include "feedmodel/lookahead.h"
#include "feedmodel/profile.h"
#include "feedmodel/segment.h"
#include "machine/machine.h"
#include "nc/move.h"

namespace camber::feedmodel {

/// A row for each segment of build_segments, look-ahead done.
std::vector<PlanRow> plan_path(const nc::Interpretation& program, const machine::Machine& machine);

/// Speed over time in row i (entry and exit speeds are those of the plan).
Trapezoid profile_of(const std::vector<PlanRow>& rows, std::size_t i);

/// Adds up the time of the segments in order.
class PlanClock {
 public:
  explicit PlanClock(double period_s) : period_s_(period_s) {}

  /// Start of a segment that begins now. A start from (almost) rest waits for the next period of the control:
  /// from stop to stop a block lasts whole periods.
  double begin(const Trapezoid& profile);
  void advance(double duration_s) { now_s_ += duration_s; }
  double now_s() const { return now_s_; }

 private:
  double period_s_;
  double now_s_ = 0;
};

/// Commanded start and duration of a segment and the move it ends in.
struct SegmentTime {
  std::uint32_t move = 0;
  bool rest = false;
  double start_s = 0, duration_s = 0;
};

/// The plan's times alone: what a fit of limits needs, at a small part of the cost of predict_feed.
std::vector<SegmentTime> segment_times(const nc::Interpretation& program, const machine::Machine& machine);

}  // namespace camber::feedmodel
