#pragma once
// A machine, tools and a material fitted to measured features of parts.
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "camber/job.h"
#include "camber/run.h"

namespace camber {
inline namespace v0 {

struct FitPartsOptions {
  std::vector<std::string> hold_out{};  ///< jobs (file without folder and ending) or parts: judged, not fitted
  bool suggest = false;  ///< FitPartsResult::printed also says what experiment would tell what is not determined
};

struct FittedPartsParameter {
  std::string name{}, unit{};
  double value = 0, start = 0;
  std::optional<double> std_error{};  ///< not given: not determined
  std::string note{};
};

struct FitPartsResult {
  std::vector<FittedPartsParameter> parameters{};
  double rms_um = 0;  ///< rms of the fitted features
  bool converged = false;
  std::string message{};  ///< how the fit ended
  /// Files that `camber fit-parts` writes to its folder: machine.toml, tools.toml, material.toml, report.html.
  std::vector<std::pair<std::string, std::string>> files{};
  std::vector<Diagnostic> diagnostics{};  ///< warnings
  std::string json{};                     ///< all figures, as `camber fit-parts --json` writes them
  std::string printed{};                  ///< the same, as `camber fit-parts` prints them
};

/// `jobs`: their [[feature]] have measured values. Throws InputError, Cancelled.
CAMBER_API FitPartsResult fit_parts(const std::vector<Job>& jobs, const FitPartsOptions& options = {},
                                    const RunOptions& run = {});

}  // namespace v0
}  // namespace camber
