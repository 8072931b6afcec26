#pragma once
// A program with rotary axes between tool-centre-point control and joint coordinates.
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "camber/job.h"
#include "camber/machine.h"
#include "camber/program.h"
#include "camber/run.h"

namespace camber {
inline namespace v0 {

struct PostOptions {
  bool to_tip = false;              ///< back to the tip; else to joint coordinates
  double tolerance_mm = 0.005;      ///< tolerance of the tip in feed moves, rounding included
  double rapid_tolerance_mm = 0.1;  ///< the same in rapids
  bool inverse_time = false;        ///< G93 in rewritten feed moves
  bool one_degree = false;          ///< divide by angles of the rotary axes instead
  double retract_mm = 50;           ///< along the tool, where axes turn back
  std::optional<int> decimals{};    ///< decimals of lengths and angles; default: the program's, at least 4
  std::string output{};             ///< name of the new program in messages; empty: that of the given one
};

struct PostResult {
  std::string text{};  ///< the new program
  std::size_t moves = 0, feed_moves = 0, feed_blocks = 0;
  double tip_bound_mm = 0;                ///< no point of the tip's way in feed moves is farther from the true one
  std::size_t turns_back = 0;             ///< places at which axes turn back
  std::size_t turns_back_in_cuts = 0;     ///< number of them in a cut
  std::vector<Diagnostic> diagnostics{};  ///< warnings
  std::string json{};                     ///< all figures, as `camber post --json` writes them
  std::string printed{};                  ///< the same, as `camber post` prints them
};

/// Throws InputError, also where the new program would leave the travel of an axis; Cancelled.
CAMBER_API PostResult post(const Program& program, const Machine& machine, const PostOptions& options = {},
                           const RunOptions& run = {});
/// With the machine of the job; also looks for collisions of its tools with the bodies of the machine.
CAMBER_API PostResult post(const Program& program, const Job& job, const PostOptions& options = {},
                           const RunOptions& run = {});

}  // namespace v0
}  // namespace camber
