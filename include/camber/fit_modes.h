#pragma once
// Natural modes of a tool, fitted to a tap test.
#include <optional>
#include <string>
#include <vector>

#include "camber/run.h"

namespace camber {
inline namespace v0 {

struct FitModesOptions {
  int tool = 1;                   ///< number of the tool in FitModesResult::tables
  std::string direction = "x";    ///< direction of the tap: "x" or "y"; "xy": the tool is alike in both
  std::optional<int> modes{};     ///< number of modes; not given: by the response itself
  double from_hz = 0, to_hz = 0;  ///< band of the fit; 0: all
};

struct FittedMode {
  double frequency_hz = 0, frequency_error_hz = 0;  ///< errors: standard errors
  double damping_percent = 0, damping_error_percent = 0;
  double stiffness_N_per_um = 0, stiffness_error_N_per_um = 0;
};

struct FitModesResult {
  std::vector<FittedMode> modes{};  ///< empty: none stands out of the noise; then there are no texts
  double misfit = 0;                ///< times the noise
  std::string tables{};             ///< [[tool.N.mode]] tables for a job
  std::string plot{};               ///< a picture of response and fit, SVG
  std::string json{};               ///< all figures, as `camber fit-modes --json` writes them
  std::string printed{};            ///< the same, as `camber fit-modes` prints them
};

/// `response`: file of the frequency response at the tip: CSV, or universal file (58). Throws InputError, Cancelled.
CAMBER_API FitModesResult fit_modes(const std::string& response, const FitModesOptions& options = {},
                                    const RunOptions& run = {});

}  // namespace v0
}  // namespace camber
