#pragma once
// The fixed-point loop: predict, move each point against its error, predict the emitted program again.
#include <functional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "deflection/predict.h"
#include "machine/job.h"

namespace camber::compensate {

enum class Stop { tolerance, stalled, rounds };
std::string to_string(Stop stop);

struct Round {
  removal::ErrorFigures error_um;  ///< of the program that this round emitted
  double largest_shift_mm = 0;
  std::size_t limited_points = 0;  ///< cut to max_shift_mm
  int static_rounds = 0;
  std::size_t unsettled = 0;
};

struct Compensation {
  std::string text;  ///< the emitted program of the best round
  removal::ErrorFigures before_um, after_um;
  std::vector<Round> rounds;  ///< rounds[0]: the program as given
  std::size_t best = 0;       ///< index into rounds
  Stop stop = Stop::rounds;
  std::size_t blocks_before = 0, blocks_after = 0, blocks_changed = 0;
  double max_shift_mm = 0;
  std::vector<removal::SurfacePoint> surface_before, surface_after;  ///< the same points, in the same order
  feedmodel::FeedSummary feed_before, feed_after;
  bool settled = true;  ///< every static solution of the first and the best round did
};

struct CompensateOptions {
  std::function<void(const std::string& what, double share)> progress;
};

/// Throws InputError. The program's text is not written anywhere.
Compensation compensate(const machine::Job& job, Diagnostics& diagnostics, const CompensateOptions& options);

}  // namespace camber::compensate
