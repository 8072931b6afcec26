#pragma once
// camber study: a grid of jobs, case after case or as a list of commands.
#include <string>

#include "cli/global_options.h"

namespace camber::cli {

struct StudyArguments {
  std::string study;
  std::string output_folder;
  std::string json;   ///< copy of study.json; empty: none
  bool list = false;  ///< print the commands of the open cases, and run none
};

int run_study(const StudyArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
