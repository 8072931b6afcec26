#pragma once
// Verification: a program that compensate has written, judged again from its text.
#include <string>
#include <vector>

#include "camber/predict.h"

namespace camber {
inline namespace v0 {

struct VerifyResult {
  std::string program{};  ///< file of the emitted program
  std::string job{};      ///< file of the job that judges it: predict() with it gives the same figures
  bool success = false;   ///< within the tolerance and the depth limit, with reliable figures
  std::string headline{};
  std::vector<std::string> reasons{};                      ///< reasons why it is not, worst first
  ErrorFigures error_um{}, deflection_um{}, contour_um{};  ///< figures of the emitted program
  double gouge_depth_p999_um = 0;                          ///< 99.9 % of the surface lies above it
  double depth_limit_um = 0;
  double machine_time_s = 0;
  std::vector<Diagnostic> diagnostics{};  ///< warnings
  std::string json{};                     ///< all figures, as `camber compensate --verify --json` writes them
  std::string printed{};                  ///< the same, as `camber compensate --verify` prints them
};

/// The files of an emitted program.
struct EmittedFiles {
  std::string program{}, record{};
  std::string job{};  ///< that verify() writes
};
/// `place`: as for verify(). Throws InputError as verify() does of the record.
CAMBER_API EmittedFiles emitted_files(const std::string& place);

/// `place`: a program that `camber compensate` or CompensateOptions::output wrote, or its folder. Reads the record
/// beside it, predicts the program as it lies on disk against the same target, and writes the job for that beside it
/// (OUT.verify.toml). Throws InputError, also where the given or the emitted program were edited since; BeyondModel,
/// Cancelled.
CAMBER_API VerifyResult verify(const std::string& place, const RunOptions& run = {});

}  // namespace v0
}  // namespace camber
