#pragma once
// camber plan PLAN.toml -o DIR [--operations T.toml] [--programs] [--json R.json]
#include <string>

#include "cli/command_line.h"
#include "cli/global_options.h"

namespace camber::cli {

struct PlanArguments {
  std::string plan;
  std::string output_folder;
  std::string operations;  ///< an edited table; empty: none
  std::string json;        ///< besides DIR/plan.json; empty: none
  bool all_programs = false;
  bool programs = false;
  bool cases_error = false;
  bool learn = false;
};

/// Throws InputError. Returns kDone or kNumbersDidNotWorkOut.
int run_plan(const PlanArguments& arguments, const GlobalOptions& options);

void add_plan_command(CLI::App& app, const GlobalOptions& options, Action& chosen);

}  // namespace camber::cli
