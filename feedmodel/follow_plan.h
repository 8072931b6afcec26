#pragma once
// A plan once more, segment by segment with its times, for those who sample it.
#include <algorithm>
#include <cstddef>

#include "base/stage.h"
#include "feedmodel/path_builder.h"
#include "feedmodel/plan.h"

namespace camber::feedmodel {

/// Calls pass(segment, motion, time, next_start_s) for all segments of a plan in order; next_start_s: when the one
/// after it begins, which may be before this one ends.
template <class Pass>
void follow_plan(const nc::Interpretation& program, const machine::Machine& machine, const MotionPlan& plan,
                 double end_s, Pass pass) {
  constexpr std::size_t kTogether = 1024;  // segments between two steps of the progress
  Stage stage("following the axes", plan.times.size());
  std::size_t i = 0;
  build_segments(program, machine, [&](const Segment& segment) {
    const SegmentTime& time = plan.times[i];
    // The pause for a whole period belongs to the segment that waits for it.
    const double next_start_s = i + 1 < plan.times.size() ? plan.times[i + 1].start_s : end_s;
    pass(segment, motion_of(plan, i, segment, machine), time, std::min(next_start_s, time.end_s()));
    if (++i % kTogether == 0) stage.advance(kTogether);
  });
}

}  // namespace camber::feedmodel
