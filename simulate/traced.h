#pragma once
// A program's form error where a servo trace measured the axes, beside that of the feed model.
#include <string>
#include <vector>

#include "feedmodel/timed_path.h"
#include "machine/job_file.h"
#include "simulate/predict_path.h"

namespace camber::simulate {

/// The other half of a prediction from a trace; the prediction itself is at the measured positions.
struct TracedRun {
  std::string trace;           ///< file
  bool by_line = false;        ///< samples were matched to the program by the line column; else by place
  double period_s = 0;         ///< of the trace
  double off_path_p95_mm = 0;  ///< distance of the axes from the programmed path in the cut
  double off_path_max_mm = 0;
  std::vector<feedmodel::TimedSample> samples;  ///< the trace's, on the program's moves
  motion::Motion model;                         ///< the feed model's
  Prediction predicted;                 ///< of the feed model: the same points of the surface, in the same order
  removal::ErrorFigures difference_um;  ///< error at the measured positions minus the feed model's
};

/// The error at the measured positions minus the feed model's, one per point, mm. `measured`: of the same target.
double difference_mm(const TracedRun& run, const Prediction& measured, std::size_t point);

/// Predicts `program`, which has the measured motion, and fills `run` from its model: both cut the same target. The
/// contour error of each is that of its own motion. `options` are of the measured one.
Prediction predict_traced(const machine::Job& job, Target& target, SimulatedProgram& program, TracedRun& run,
                          const PredictOptions& options);

}  // namespace camber::simulate
