#pragma once
// The commands of a job that a study or ranks of MPI run too, and what they have in common.
#include <string>
#include <vector>

#include "camber/adapt.h"
#include "camber/compensate.h"
#include "camber/predict.h"
#include "cli/command_line.h"
#include "simulate/predict_path.h"

namespace camber::cli {

struct PredictArguments {
  std::string job{};
  std::string json{};        ///< empty: only summary.json in the folder
  std::size_t sections = 0;  ///< of the path; 0: it is cut as a whole
  PredictOptions options{};
};

/// Writes the folder of a prediction. Throws InputError. Returns kDone or kNumbersDidNotWorkOut.
int run_predict(const PredictArguments& arguments, const GlobalOptions& options);

/// What the terminal shows of a prediction whose first warnings are `settled`, and its JSON. Returns as run_predict.
int finish_prediction(const PredictResult& result, std::size_t settled, const std::string& json,
                      const GlobalOptions& options);

struct CompensateArguments {
  std::string job{};
  std::string report{};  ///< empty: none
  std::string json{};    ///< empty: none
  CompensateOptions options{};
};

/// Throws InputError. Returns kDone or kNumbersDidNotWorkOut (a static solution did not settle, or the residual is
/// over the tolerance).
int run_compensate(const CompensateArguments& arguments, const GlobalOptions& options,
                   const simulate::Predictor& predictor = simulate::predict);

struct AdaptArguments {
  std::string job{};
  std::string output{};
  std::string report{};      ///< empty: none
  std::string json{};        ///< empty: none
  bool keep_anyway = false;  ///< write the program even where a limit is not kept
  AdaptOptions options{};
};

/// Throws InputError. Returns kDone or kNumbersDidNotWorkOut.
int run_adapt(const AdaptArguments& arguments, const GlobalOptions& options);

/// Every file that a job names, and those of the command line.
std::vector<std::string> files_read(const std::string& job_path, std::vector<std::string> others = {});
bool has_several_programs(const std::string& job_path);

/// The answer to --effective-config.
int print_effective_job(const std::string& path, const GlobalOptions& options);

}  // namespace camber::cli
