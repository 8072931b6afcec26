#pragma once
// camber compensate J.toml -o OUT.nc [--report R.html] [--json R.json]
#include <string>
#include <vector>

#include "api/commands/compensate.h"
#include "cli/global_options.h"

namespace camber::cli {

struct CompensateArguments {
  std::string job;
  std::string output;
  std::string report;    ///< empty: none
  std::string json;      ///< empty: none
  bool dry_run = false;  ///< write no program
  bool header = false, header_hash = false;
  std::vector<std::string> uncertainty;  ///< files or percentages
  std::string measured, measured_program;
  std::vector<double> check_voxels_mm;
  std::optional<double> time_budget_percent{};
  std::vector<std::string> levers{};  ///< by name; empty: the job's
  bool keep_anyway = false;           ///< write the program even where it is no better than the given one
};

/// The request of the computation, from the arguments of the command line.
api::CompensateRequest compensate_request(const CompensateArguments& arguments);

/// Throws InputError. Returns kDone or kNumbersDidNotWorkOut (a static solution did not settle, or the residual is
/// over the tolerance).
int run_compensate(const CompensateArguments& arguments, const GlobalOptions& options,
                   const simulate::Predictor& predictor = simulate::predict);

}  // namespace camber::cli
