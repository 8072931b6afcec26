#pragma once
// camber protocol: programs to run on a machine so that fit-feed has what it needs.
#include <string>

#include "cli/global_options.h"

namespace camber::cli {

struct ProtocolArguments {
  std::string machine;
  std::string folder;
  bool part = false;       ///< a test piece for fit-parts instead
  double diameter_mm = 6;  ///< diameter of the test piece's end mill
};

/// Writes the programs, a .parts.csv beside each, and prints the purpose of each; of a test piece its program, job and
/// table of measured values. Throws InputError.
int run_protocol(const ProtocolArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
