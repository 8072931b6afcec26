#pragma once
// camber feed: predicted axes of a program, to feed.csv and a summary.
#include <string>

#include "cli/global_options.h"
#include "nc/interpreter.h"

namespace camber::cli {

struct FeedArguments {
  std::string program;
  std::string machine;
  std::string output;  ///< feed.csv; empty: none
  std::string json;    ///< empty: none
  std::string report;  ///< page of a machine with rotary axes; empty: none
  nc::InterpreterOptions interpreter;
};

/// camber feed P.nc --machine M.toml [-o feed.csv] [--report R.html] [--json R.json]. Throws InputError. Returns kDone.
int run_feed(const FeedArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
