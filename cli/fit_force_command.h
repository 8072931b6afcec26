#pragma once
// camber fit-force: a material from dynamometer logs.
#include <string>
#include <vector>

#include "cli/global_options.h"

namespace camber::cli {

struct FitForceArguments {
  std::vector<std::string> logs;
  std::vector<std::string> jobs;  ///< one for each log, or one for all
  std::string output;             ///< material.toml
  std::string json;               ///< empty: none
};

/// Throws InputError. Returns kDone, or kNumbersDidNotWorkOut when the fit did not converge or makes no sense (the
/// material is written all the same, and a sentence says so).
int run_fit_force(const FitForceArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
