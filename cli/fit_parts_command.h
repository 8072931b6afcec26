#pragma once
// camber fit-parts: a model from measured parts.
#include <string>
#include <vector>

#include "cli/global_options.h"

namespace camber::cli {

struct FitPartsArguments {
  std::vector<std::string> jobs;
  std::string folder;                 ///< machine.toml, tools.toml, material.toml, report.html
  std::vector<std::string> hold_out;  ///< names of jobs or parts
  bool suggest = false;
  std::string json;  ///< empty: none
};

/// Throws InputError. Returns kDone, or kNumbersDidNotWorkOut where the fit did not converge; the files are written all
/// the same.
int run_fit_parts(const FitPartsArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
