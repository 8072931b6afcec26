#pragma once
// Actual axis positions and feed at every interpolation period.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "camber/machine.h"
#include "camber/program.h"
#include "camber/run.h"

namespace camber {
inline namespace v0 {

/// A row of feed.csv: the predicted actual axes.
struct FeedPoint {
  double t_s = 0;
  double x_mm = 0, y_mm = 0, z_mm = 0;
  double vx_mm_per_min = 0, vy_mm_per_min = 0, vz_mm_per_min = 0;
  double feed_cmd_mm_per_min = 0;  ///< programmed; for a rapid its maximum speed
  double feed_mm_per_min = 0;
  std::int64_t block = 0;  ///< 1-based line being commanded
};

/// Rotary axes and pose of the tool of a row of feed.csv, in programs that turn rotary axes. There x_mm, y_mm and z_mm
/// of FeedPoint are those of the machine, and feed_mm_per_min is what F counts in the block.
struct PosePoint {
  double a_deg = 0, b_deg = 0, c_deg = 0;           ///< 0 for axes that the machine does not have
  double tip_x_mm = 0, tip_y_mm = 0, tip_z_mm = 0;  ///< in the program's frame
  double axis_x = 0, axis_y = 0, axis_z = 0;        ///< unit; from the tip towards the spindle
};

struct FeedOptions {
  bool points = true;  ///< keep the points; 80 bytes each
  std::string csv{};   ///< file: feed.csv, a row for each point; empty: none
  bool page = false;   ///< also FeedResult::page, in programs that turn rotary axes alone
};

struct FeedResult {
  double time_s = 0;
  double cutting_time_s = 0;              ///< commanded time in G1, G2, G3
  std::size_t blocks = 0;                 ///< blocks with motion
  std::vector<FeedPoint> points{};        ///< one per interpolation period
  std::vector<PosePoint> poses{};         ///< pose at each point, in programs that turn rotary axes; else empty
  std::vector<Diagnostic> diagnostics{};  ///< warnings
  std::string json{};                     ///< all figures, as `camber feed --json` writes them
  std::string printed{};                  ///< the same, as `camber feed` prints them
  std::string page{};                     ///< the same, as `camber feed --report` writes them
};

/// Throws InputError, Cancelled.
CAMBER_API FeedResult feed(const Program& program, const Machine& machine, const FeedOptions& options = {},
                           const RunOptions& run = {});

}  // namespace v0
}  // namespace camber
