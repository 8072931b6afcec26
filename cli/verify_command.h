#pragma once
// camber compensate --verify DIR [--json R.json]
#include <string>

#include "cli/global_options.h"

namespace camber::cli {

struct VerifyArguments {
  std::string place;  ///< folder of an emitted program, or the program
  std::string json;   ///< empty: none
};

/// Judges a program that compensate wrote, from its text and its record, and writes the job with which predict gives
/// the same figures: OUT.verify.toml beside OUT.nc. Throws InputError. Returns kDone or kNumbersDidNotWorkOut, as
/// compensate does.
int run_verify(const VerifyArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
