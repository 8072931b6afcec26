#pragma once
// camber fit-modes: natural modes of a tool from a tap test.
#include <optional>
#include <string>

#include "cli/global_options.h"

namespace camber::cli {

struct FitModesArguments {
  std::string response;
  int tool = 1;
  std::string direction = "x";  ///< "y"; "xy": the tool is alike in both
  std::optional<int> modes;
  double from_hz = 0, to_hz = 0;  ///< band of the fit; 0: all
  std::string output = "modes.toml", plot, json;
};

/// "FROM:TO", Hz, into the band. False where it is not.
bool parse_band(const std::string& text, FitModesArguments& into);

/// Throws InputError. Returns kDone, or kNumbersDidNotWorkOut where no mode was found; then nothing is written.
int run_fit_modes(const FitModesArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
