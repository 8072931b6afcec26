#pragma once
// Lines of a trace or a log: speeds that axes hold in them, their top speeds, and those with rotary motion.
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calib/fit_feed_model.h"
#include "calib/fit_limits.h"
#include "calib/stretch.h"
#include "feedmodel/segment.h"
#include "machine/machine_model.h"
#include "nc/move.h"

namespace camber::calib {

using JointSpeeds = std::array<double, kJoints>;  ///< x, y, z, a, b, c: mm/s or degrees/s

/// What a line asks of the axes; infinite in rapids. `counts`: a rapid or a line without tool-centre-point control,
/// where axes keep a speed by themselves.
struct AskedSpeeds {
  JointSpeeds per_s{};
  double feed_per_s = 0;  ///< along the path; 0: a rapid
  bool rotary_alone = false;
  bool counts = false;
  bool axes_apart = false;  ///< dog-leg rapid
};

/// A speed that all axes hold for 60 ms or longer in one move; single samples, and the sum of two blocks that overlap,
/// are none.
struct HeldSpeed {
  JointSpeeds speed{};
  double path_per_s = 0;  ///< in what F counts
  double duration_s = 0;
  std::uint32_t line = 0;
  std::size_t first = 0;  ///< sample
  AskedSpeeds asked;
};

/// Empty for a trace without lines.
std::vector<HeldSpeed> held_speeds(const FeedRun& run, const machine::Machine& machine);

/// What positions of traces are rounded to, mm or degrees.
inline constexpr double kTraceRounding = 1e-4;

/// The logged stretches of one program: one for each geometry, in the order of the program, each with the rapids
/// around it, a rest before.
struct LoggedLines {
  std::string program_name;
  std::unique_ptr<nc::Interpretation> program;  ///< these stretches alone; `lines` refers to it
  TimedLines lines;
};

/// Holds out the time of every `keep_back_every`-th stretch. `count`: the number of parts before, which goes on, so
/// that no two parts are of one group.
std::vector<LoggedLines> logged_lines(const std::vector<StretchRun>& runs, int keep_back_every, std::size_t& count);

struct LineFeed {
  std::shared_ptr<const feedmodel::Turn> turn;  ///< null: a line without motion
  bool rotary_alone = false;                    ///< X, Y and Z rest
  bool turns = false;                           ///< a rotary axis moves
  bool cutting = false;
  /// Along the path, /s: mm, or degrees where only rotary axes move. 0 for rapids.
  double feed_per_s = 0;
  double length = 0;                    ///< of the same path
  Vec3 asked_deg_per_s = Vec3::Zero();  ///< of a, b, c; infinite for those that turn in a rapid
};

/// Returns the feed of the last move of each line, by its 1-based number. Requires kinematics::has_rotary_motion.
std::vector<LineFeed> feeds_of_lines(const nc::Interpretation& program, const machine::Machine& machine);

/// The top speed of one joint, mm/s or degrees/s.
struct TopSpeed {
  std::optional<FittedValue> limit;  ///< the axis was at its limit
  int moves = 0;                     ///< that show it
  double highest = 0;                ///< speed that some move holds: the limit is no lower
};

/// Returns the top speeds of x, y, z, a, b, c.
///
/// The axes share one path, so that an axis is known to be at its limit only in a move that asks it for more,
/// where it turns as fast as it ever does, and where every other axis stays below a speed that it holds elsewhere. In a
/// dog-leg rapid each axis has its own time, and counts by itself. Arcs and moves under tool-centre-point control do
/// not count: their axes keep no speed by themselves.
std::array<TopSpeed, kJoints> top_speeds(const std::vector<HeldSpeed>& held);

}  // namespace camber::calib
