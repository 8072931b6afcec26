#pragma once
// camber resegment: runs of G1 laid out again in segments that are just long enough for the control.
#include <string>

#include "cli/global_options.h"
#include "nc/interpreter.h"

namespace camber::cli {

struct ResegmentArguments {
  std::string program, output;
  std::string machine;
  std::string json;    ///< empty: none
  std::string report;  ///< the page; empty: none
  double tolerance_mm = 0;
  double length_mm = 0;   ///< 0: the fastest is looked for
  double contour_mm = 0;  ///< most that the predicted axes may stray; 0: see repath/fastest.h
  nc::InterpreterOptions interpreter;
};

/// Throws InputError. Returns kDone, or kNumbersDidNotWorkOut where no length keeps the axes as near as asked for.
int run_resegment(const ResegmentArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
