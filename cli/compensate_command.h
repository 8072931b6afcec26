#pragma once
// camber compensate J.toml -o OUT.nc [--report R.html] [--json R.json]
#include <string>

#include "cli/global_options.h"

namespace camber::cli {

struct CompensateArguments {
  std::string job;
  std::string output;
  std::string report;  ///< empty: none
  std::string json;    ///< empty: none
};

/// Throws InputError. Returns kDone or kNumbersDidNotWorkOut (a static solution did not settle, or the residual is
/// over the tolerance).
int run_compensate(const CompensateArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
