#pragma once
// camber lobes: stability lobes of a tool of a job.
#include <optional>
#include <string>
#include <vector>

#include "cli/global_options.h"

namespace camber::cli {

struct LobesArguments {
  std::string job;
  int tool = -1;  ///< -1: the job's only one
  double radial_mm = 0;
  std::vector<double> speeds_rpm;
  bool up = false;              ///< else down
  std::string method = "semi";  ///< or "zero"
  double chip_mm = 0.05, process_damping_N_per_mm = 0;
  std::string output = "lobes.csv", plot, json;  ///< plot, json: empty: none
};

/// "FROM:TO:N": N speeds, the first and the last as given. Nothing where it is not.
std::optional<std::vector<double>> parse_speeds(const std::string& text);

/// Throws InputError.
int run_lobes(const LobesArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
