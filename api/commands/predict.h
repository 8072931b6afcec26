#pragma once
// The work of camber predict: a job made ready, cut, judged, and written to a folder.
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "machine/job_file.h"
#include "simulate/pieces.h"
#include "simulate/setup.h"
#include "simulate/traced.h"

namespace camber::api {

/// Reports the stage that runs and, where it is known, the fraction of it that is done (0 to 1).
using StepProgress = std::function<void(const std::string& what, std::optional<double> share)>;

struct PredictRequest {
  std::string folder;         ///< for the files; empty: none
  std::size_t forces_at = 0;  ///< line whose forces are kept over one turn; 0: none
  std::string trace{};        ///< servo trace at whose positions is cut; empty: the feed model's
  std::string columns{};      ///< column map of the trace; empty: its header names columns as Camber does
  bool meshes = false;        ///< also machined.stl, machined.ply and form_error_mesh.ply
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
PreparedJob prepare(const machine::Job& job, const PredictRequest& request, Diagnostics& diagnostics);

/// Cuts and judges. The target and the blank are given up on the way. `of_cut`: what only the cut shows.
simulate::Prediction predict_prepared(const machine::Job& job, PreparedJob& prepared, const PredictRequest& request,
                                      Diagnostics& of_cut);

/// Ends a prediction: releases data that nothing reads any more, and checks the load of the spindle.
void finish_prediction(const machine::Job& job, PreparedJob& prepared, simulate::Prediction& prediction,
                       Diagnostics& of_cut);

/// Every file of the folder, summary.json last, and `json` where a file is named. Whatever cannot be written goes to
/// `failed`. The machined stock is given up once it is saved.
void write_prediction(const machine::Job& job, const PreparedJob& prepared, simulate::Prediction& prediction,
                      const PredictRequest& request, const std::string& summary, const Diagnostics& diagnostics,
                      Diagnostics& failed);

/// A sentence for each reason reasons why the figures are not reliable; empty: none.
std::vector<std::string> doubts_of(const machine::Job& job, const simulate::SimulatedProgram& program,
                                   const simulate::Prediction& prediction);

}  // namespace camber::api
