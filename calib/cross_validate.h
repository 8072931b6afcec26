#pragma once
// Leave one trace out: each is predicted by a machine that was fitted on the others.
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "calib/fit_feed_model.h"

namespace camber::calib {

struct HeldOutRun {
  std::string program_name;
  FeedAccuracy accuracy;                 ///< of the model fitted without it
  FeedAccuracy constant_feed;            ///< baseline: the programmed feed everywhere, no lag
  FeedAccuracy stop_every_block;         ///< baseline: the fitted accelerations, rest at the end of every block
  std::array<double, 3> drive_rms_mm{};  ///< drive model alone, driven by the traced command; 0: the axis rests
  std::vector<std::pair<char, double>> rotary_drive_rms_deg;  ///< the same of a, b, c, of the axes that the trace has
  bool converged = false;
};

/// Empty for fewer than two runs. Runs whose trace has no lines are fitted on, but not judged. Deterministic.
/// `logs`: logged times that every fit takes beside the traces.
std::vector<HeldOutRun> leave_one_out(std::vector<FeedRun> runs, const machine::Machine& start,
                                      const FitFeedOptions& options, const std::vector<StretchRun>& logs = {});

}  // namespace camber::calib
