#pragma once
// Virtual copy milling: a program made from the part itself.
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "camber/run.h"

namespace camber {
inline namespace v0 {

/// One period of the control.
struct CopyTick {
  double t_s = 0, x_mm = 0, y_mm = 0, z_mm = 0;
  double feed_mm_per_min = 0;  ///< actual
  double load_N = 0;           ///< lateral force of the last tooth passing; 0 in air
};

struct CopyOptions {
  std::function<void(const CopyTick&)> stream{};  ///< called with every tick, in order; may be empty
  std::string hardness{};                         ///< file: parts of the material that are harder; empty: none
  std::optional<double> stop_after_s{};           ///< the tool stops here, and is lifted
  std::string stock{};                            ///< file: what is left is written to it; empty: none
  bool page = false;                              ///< also CopyResult::page
  std::string output = "program.nc";              ///< name of the program in messages and on the page
};

/// Result of one [[copy]] table.
struct CopiedOperation {
  int tool = 0;
  std::string mode{};  ///< "scanning-line", "contour-line", "drilling"
  double time_s = 0, cutting_s = 0, removed_mm3 = 0;
  std::size_t levels = 0, passes = 0, ramps = 0, plunges = 0, retracts = 0;
  bool nothing_left = false;
  double target_N = 0, max_N = 0;  ///< lateral force; target 0: none
  /// Fraction with 80 to 105 % of the target load among the tooth passings whose feed no bound holds.
  double within_share = 0;
  std::size_t trochoid_circles = 0;  ///< instead of full cuts, of the trochoids that were begun
};

struct CopyResult {
  std::string program{};                      ///< text
  std::vector<CopiedOperation> operations{};  ///< in order
  double time_s = 0, removed_mm3 = 0;
  std::size_t ticks = 0, blocks = 0;
  double gouge_um = 0;                      ///< greatest depth of the path in the part
  double left_p95_um = 0, left_max_um = 0;  ///< on the part, where tools can touch it
  double unreached_mm2 = 0;                 ///< surface of the part with material that no tool can touch
  bool stopped = false;                     ///< by stop_after_s
  std::string log{};                        ///< changes of feed and depths, CSV
  std::vector<Diagnostic> diagnostics{};    ///< warnings
  std::string json{};                       ///< all figures, as `camber copy --json` writes them
  std::string printed{};                    ///< the same, as `camber copy` prints them
  std::string page{};                       ///< the same, as `camber copy --report` writes them
};

/// Makes the paths of a job's [[copy]] tables and cuts the stock along them. Writes no file but CopyOptions::stock.
/// Throws InputError, Cancelled.
CAMBER_API CopyResult copy(const std::string& job_path, const CopyOptions& options = {}, const RunOptions& run = {});

/// Text of such a job and its machine with all defaults filled in. Throws InputError.
CAMBER_API std::string copy_job_toml(const std::string& job_path, const RunOptions& run = {});

}  // namespace v0
}  // namespace camber
