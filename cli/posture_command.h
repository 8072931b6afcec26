#pragma once
// camber posture: a three-axis finishing program made one of five axes.
#include <optional>
#include <string>

#include "cli/global_options.h"
#include "nc/five_axis_words.h"
#include "nc/interpreter.h"
#include "posture/choose.h"

namespace camber::cli {

struct PostureArguments {
  std::string program, output, job;
  std::string json, report;  ///< empty: none
  std::optional<int> tool{};
  double step_mm = 1;
  double overhang_step_mm = 0;  ///< greater than zero: the shortest overhang is looked for
  bool least_error = false;     ///< that of the least expected error instead
  posture::PostureOptions options;
  std::optional<nc::OneDirection> written{};
  nc::InterpreterOptions interpreter;
};

/// Throws InputError. Returns kDone, or kNumbersDidNotWorkOut where the tool is not clear everywhere.
int run_posture(const PostureArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
