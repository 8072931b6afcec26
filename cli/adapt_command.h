#pragma once
// camber adapt J.toml -o OUT.nc [--report R.html] [--json R.json]
#include <optional>
#include <string>

#include "cli/global_options.h"

namespace camber::cli {

struct AdaptArguments {
  std::string job;
  std::string output;
  std::string report;  ///< empty: none
  std::string json;    ///< empty: none
  std::optional<double> time_limit_s{};
  bool sweep = false;
  bool keep_anyway = false;  ///< write the program even where a limit is not kept
};

/// Throws InputError. Returns kDone or kNumbersDidNotWorkOut.
int run_adapt(const AdaptArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
