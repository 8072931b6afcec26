#pragma once
// From a three-axis finishing program to five axes.
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "camber/job.h"
#include "camber/program.h"
#include "camber/run.h"

namespace camber {
inline namespace v0 {

struct PostureOptions {
  std::string mode = "chosen";  ///< "chosen", "normal", "lead-tilt", "seed"
  bool indexed = false;         ///< one direction for the whole operation instead
  std::string write_as{};       ///< indexed: "tilted", "dynamic", "joints", "tip"; empty: as the control has it
  std::optional<int> tool{};    ///< default: the only one of the job
  double step_mm = 1;           ///< between the points of the path
  double overhang_step_mm = 0;  ///< greater than zero: the shortest overhang is looked for
  bool least_error = false;     ///< with it: the overhang of the least expected error
  double clearance_mm = 1;
  bool stock = true;                   ///< that of the job is an obstacle, but for the flutes
  double lead_deg = 10, tilt_deg = 0;  ///< lead-tilt
  double max_tilt_deg = 75;
  double least_angle_deg = 10;  ///< smallest angle between tool and normal
  bool page = false;            ///< also PostureResult::page
  std::string output{};         ///< name of the new program in messages; empty: that of the given one
};

struct PostureFigures {
  double overhang_mm = 0;
  std::size_t points = 0, contacts = 0;
  std::size_t unclear = 0;  ///< points at which, or on the way to which, the tool is too near or swings
  double rotary_motion_deg = 0;
  double mean_angle_deg = 0, max_angle_deg = 0;  ///< angles between tool and normal
  double compliance_um_per_N = 0;                ///< normal to the part
  double lag_um = 0;                             ///< left by axes that follow late, normal to the part, mean
  double error_um = 0;                           ///< expected form error, mean magnitude: deflection and lag
  double time_s = 0;                             ///< machine time of the program
};

struct PostureResult {
  bool success = false;                     ///< the tool is clear everywhere
  std::size_t blocked_line = 0;             ///< where no direction is clear; 0: none
  std::size_t unclear_line = 0;             ///< the first with points of figures.unclear; 0: none
  std::string text{};                       ///< the new program; empty: blocked
  PostureFigures figures{};                 ///< figures of this overhang
  std::vector<PostureFigures> overhangs{};  ///< with overhang_step_mm: from the given one to the shortest
  std::vector<Diagnostic> diagnostics{};    ///< warnings
  std::string json{};                       ///< all figures, as `camber posture --json` writes them
  std::string printed{};                    ///< the same, as `camber posture` prints them; empty: blocked
  std::string page{};                       ///< the same, as `camber posture --report` writes them; empty: blocked
};

/// The program is that of three axes; the job names machine, tool and part. Throws InputError, Cancelled;
/// std::invalid_argument for a word of `mode` or `write_as` that is none of these.
CAMBER_API PostureResult posture(const Program& program, const Job& job, const PostureOptions& options = {},
                                 const RunOptions& run = {});

}  // namespace v0
}  // namespace camber
