#pragma once
// A prediction: a job made ready, cut, judged, and written to a folder.
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "api/run.h"
#include "base/diagnostics.h"
#include "camber/predict.h"
#include "machine/job_file.h"
#include "removal/form_error.h"
#include "simulate/pieces.h"
#include "simulate/setup.h"
#include "simulate/traced.h"

namespace camber::api {

/// Reports the stage that runs and, where it is known, the fraction of it that is done (0 to 1).
using StepProgress = std::function<void(const std::string& what, std::optional<double> share)>;

/// Inputs of a prediction beside its options.
struct PredictionWork {
  StepProgress progress{};
  simulate::TargetWork work{};  ///< target work that other processes have done
  /// The job's, where this process has read them before: they are used up. Null: they are read.
  std::shared_ptr<simulate::ReadPrograms> programs{};
};

/// A job that is ready for its prediction. For a prediction from a trace `setup.program` has the measured motion and
/// `traced` the feed model's.
struct PreparedJob {
  simulate::Setup setup;
  simulate::PredictOptions options;
  std::optional<simulate::TracedRun> traced{};

  const simulate::TracedRun* traced_run() const { return traced ? &*traced : nullptr; }
};

/// All that comes before the long work; what it found should be shown now. Throws InputError.
PreparedJob prepare(const machine::Job& job, const PredictOptions& options, const PredictionWork& given,
                    Diagnostics& diagnostics);

/// Cuts and judges. The target and the blank are given up on the way. `of_cut`: what only the cut shows.
simulate::Prediction predict_prepared(const machine::Job& job, PreparedJob& prepared, const StepProgress& progress,
                                      Diagnostics& of_cut);

/// Ends a prediction: releases data that nothing reads any more, and checks the load of the spindle.
void finish_prediction(const machine::Job& job, PreparedJob& prepared, simulate::Prediction& prediction,
                       Diagnostics& of_cut);

/// A prediction that is done, with what its files show.
struct FinishedPrediction {
  const machine::Job& job;
  const PreparedJob& prepared;
  simulate::Prediction& prediction;
  std::vector<std::string> doubts;  ///< why the figures are not reliable; see doubts_of
  /// JSON text with what belongs to this kind of prediction; empty: as it is.
  std::function<std::string(const std::string& json)> with_more{};
};

/// Fills `result` but for `feed` and the meshes, and writes the files of options.output_folder, summary.json last; the
/// machined stock is given up once it is saved. `found`: all of it. Throws InputError, or fills `unwritten`.
void finish_result(const FinishedPrediction& done, const PredictOptions& options, Run& run, const Diagnostics& found,
                   PredictResult& result);

/// A sentence for each reason why the figures are not reliable; empty: none.
std::vector<std::string> doubts_of(const machine::Job& job, const simulate::SimulatedProgram& program,
                                   const simulate::Prediction& prediction);

ErrorFigures figures_of(const removal::ErrorFigures& figures);

}  // namespace camber::api
