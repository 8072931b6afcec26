#pragma once
// Feeds by load: the program of a job with F words that keep the loads of the cut within limits, and with S words that
// keep it from chatter.
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "camber/job.h"
#include "camber/run.h"

namespace camber {
inline namespace v0 {

struct AdaptOptions {
  std::optional<double> time_limit_s{};  ///< scales the limits until the program takes no longer
  bool sweep = false;                    ///< also AdaptResult::sweep
  bool page = false;                     ///< also AdaptResult::page
  std::string output{};                  ///< name of the new program on the page
};

/// A load that [adapt] limits names, in the unit of its key.
struct AdaptedLoad {
  std::string name{};  ///< the key: "force_N"
  double limit = 0, max_before = 0, max_after = 0;
  double max_elsewhere = 0;  ///< after, outside the blocks of AdaptResult::over_limit
};

/// A block that remains beyond a limit.
struct OverLimitBlock {
  std::size_t line = 0, new_line = 0;  ///< line of the given and of the new program
  std::string name{};                  ///< name of the load
  double value = 0;
  double feed_mm_per_min = 0;  ///< actual
  std::string reason{};
};

/// The time for all limits times a factor, by the loads of the last prediction.
struct LimitSweepRow {
  double factor = 1, time_s = 0;
  double constant_feed_mm_per_min = 0;  ///< the greatest single feed within the limits; 0: none
  double constant_time_s = 0;
};

/// With the limit chatter_margin: a tool at a programmed spindle speed.
struct AdaptedSpeed {
  int tool = 0;
  double speed_before_rpm = 0, speed_after_rpm = 0;  ///< the same: not changed
  double margin_before = 0, margin_after = 0;        ///< depth over critical depth, the greatest; above 1 unstable
  std::size_t line = 0, new_line = 0;                ///< where, in the given and in the new program
  double chatter_hz = 0;                             ///< frequency that is heard there before
  double kept_depth_mm = 0;     ///< axial depth that would keep the limit there at the programmed speed
  double stable_speed_rpm = 0;  ///< speed that keeps the limit; 0: none, or the programmed one does
  double probability = 0;       ///< that the new program chatters, with the modes at their errors
  bool modes_given = false;     ///< else those of the tool's beam, with a usual damping
  bool kept = false;            ///< margin_after is within the limit
  std::string reason{};         ///< why stable_speed_rpm is not in the new program
};

struct AdaptResult {
  std::string program{};               ///< text of the new program
  bool success = false;                ///< within the limits but for over_limit, within the time, with reliable figures
  std::vector<std::string> reasons{};  ///< why not
  double time_before_s = 0, time_after_s = 0;
  double constant_feed_mm_per_min = 0, constant_time_s = 0;  ///< see LimitSweepRow
  std::size_t blocks_before = 0, blocks_after = 0, blocks_changed = 0;
  std::vector<AdaptedLoad> loads{};
  std::vector<OverLimitBlock> over_limit{};
  std::vector<AdaptedSpeed> speeds{};
  std::vector<LimitSweepRow> sweep{};
  double limit_factor = 1;                ///< by which time_limit_s scaled the limits
  std::vector<Diagnostic> diagnostics{};  ///< warnings
  std::string json{};                     ///< all figures, as `camber adapt --json` writes them
  std::string printed{};                  ///< the same, as `camber adapt` prints them
  std::string page{};                     ///< the same, as `camber adapt --report` writes them
};

/// Writes no file. Throws InputError, Cancelled.
CAMBER_API AdaptResult adapt(const Job& job, const AdaptOptions& options = {}, const RunOptions& run = {});

}  // namespace v0
}  // namespace camber
