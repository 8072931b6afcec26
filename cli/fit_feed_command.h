#pragma once
// camber fit-feed: a machine file from programs and the servo traces that they left.
#include <string>
#include <vector>

#include "cli/global_options.h"
#include "nc/interpreter.h"

namespace camber::cli {

struct FitFeedArguments {
  std::vector<std::string> programs, traces;  ///< as many of one as of the other
  std::string columns;                        ///< column map; empty: our CSV
  std::string machine;
  std::string output;           ///< fitted.toml
  std::string json;             ///< empty: none
  std::string block_time_plot;  ///< empty: none
  std::string report;           ///< page; empty: none
  bool update = false;          ///< refine the machine file: its corner law stands
  bool leave_one_out = false;   ///< judge each servo trace by a fit on the others as well
  nc::InterpreterOptions interpreter;
};

/// camber fit-feed. Throws InputError. Returns kDone, or kNumbersDidNotWorkOut when the fit did not converge (the
/// machine file is written all the same, and a sentence says so).
int run_fit_feed(const FitFeedArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
