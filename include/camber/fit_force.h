#pragma once
// Cutting force coefficients of a material, fitted to dynamometer logs.
#include <optional>
#include <string>
#include <vector>

#include "camber/run.h"

namespace camber {
inline namespace v0 {

struct ForceLogFile {
  std::string log{};  ///< samples, or a table of means, CSV
  std::string job{};  ///< job.toml with the tool and [force_log]
};

struct FittedCoefficient {
  std::string name{}, unit{};
  double value = 0;
  std::optional<double> std_error{};  ///< not given: not fitted, or the data does not determine it
  std::string note{};
};

struct FitForceResult {
  std::vector<FittedCoefficient> coefficients{};
  double residual_rms_N = 0;
  std::optional<double> held_out_rms_N{};
  bool success = false;                   ///< the fit converged, and its values are plausible
  std::string message{};                  ///< how it ended
  std::vector<Diagnostic> diagnostics{};  ///< warnings
  std::string material{};                 ///< text of material.toml
  std::string json{};                     ///< all figures, as `camber fit-force --json` writes them
  std::string printed{};                  ///< the same, as `camber fit-force` prints them
};

/// Throws InputError, Cancelled.
CAMBER_API FitForceResult fit_force(const std::vector<ForceLogFile>& logs, const RunOptions& run = {});

}  // namespace v0
}  // namespace camber
