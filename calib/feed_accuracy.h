#pragma once
// Comparison of the feed model with a servo trace: time and path speed of the actual axes, part by part.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "calib/trace.h"
#include "machine/machine_model.h"
#include "nc/move.h"

namespace camber::calib {

/// A stretch of consecutive lines of the program that is judged as one.
struct TracePart {
  std::uint32_t line_first = 0, line_last = 0;  ///< 1-based, both included
  double feed_mm_per_s = 0;                     ///< programmed
};

/// Reads a CSV with the columns line_first, line_last, feed_mm_min (others are left out). Throws InputError.
std::vector<TracePart> read_parts(const std::string& path);

/// Parts of a program without such a list: runs of feed moves of one feed between rapids, dwells and rests.
std::vector<TracePart> parts_of(const nc::Interpretation& program);
/// The same for any machine: in programs with rotary motion the feed of a part is along its path (degrees/s where only
/// rotary axes move), and moves in inverse time (G93) follow each other in one part.
std::vector<TracePart> parts_of(const nc::Interpretation& program, const machine::Machine& machine);

/// What the machine does at a place of the path. Corner: within 20 ms of the change to another block; arc: inside an
/// arc; feed: at 98 % of the programmed feed or more; ramp: between them.
enum class PathState { corner, arc, ramp, feed };
inline constexpr std::array<const char*, 4> kPathStates{"corner", "arc", "ramp", "programmed feed"};

/// Path speeds of a part, mm/s (degrees/s where F counts degrees), at stations evenly over the fraction of its length.
struct SpeedProfiles {
  std::vector<float> traced, model;
};

struct PartAccuracy {
  TracePart part;
  double time_trace_s = 0, time_model_s = 0;  ///< commanded
  double speed_rms_percent = 0;               ///< over the stations, in % of the programmed feed
  double speed_p95_percent = 0;
  SpeedProfiles speeds{};  ///< FeedAccuracyOptions::kept_stations of them
};

/// RMS of predicted minus traced speed, in % of the programmed feed.
struct SpeedResidual {
  std::size_t stations = 0;
  double rms_percent = 0;
};

struct FeedAccuracy {
  double time_trace_s = 0, time_model_s = 0;  ///< from the first to the last commanded motion
  double time_error_percent = 0;
  double part_time_error_percent = 0;  ///< mean of the parts' absolute errors
  double speed_rms_percent = 0;        ///< over the stations of all parts
  double speed_p95_percent = 0;
  std::vector<PartAccuracy> parts;
  std::array<SpeedResidual, kPathStates.size()> by_state{};  ///< path speed; by PathState of the trace
  std::array<SpeedResidual, 3> by_axis{};  ///< speed of x, y, z in what F counts; without parts in degrees
};

struct FeedAccuracyOptions {
  std::size_t stations = 2000;    ///< a part, evenly over the fraction of path length
  std::size_t kept_stations = 0;  ///< of them, for a picture; at most `stations`
  double speed_window_s = 0.004;  ///< speeds are taken over this time: a trace is rounded to 0.1 um
};

/// How the errors of the parts' times lie, in %.
struct PartTimes {
  std::size_t parts = 0, over = 0;  ///< over: beyond half a percent
  double mean = 0, p90 = 0, worst = 0;
};
PartTimes part_times(const FeedAccuracy& accuracy);

/// Baseline: every part at its programmed feed from its first to its last point, without the machine's lag. Times are
/// those of the parts alone.
FeedAccuracy constant_feed_accuracy(const ServoTrace& trace, const nc::Interpretation& program,
                                    const machine::Machine& machine, const std::vector<TracePart>& parts,
                                    const FeedAccuracyOptions& options);

/// Path speed of the actual axes over the fraction of path length, predicted against traced. A part begins with its
/// first commanded sample and ends when another line is commanded (its tail, where the axes still come up
/// while line is 0, belongs to it). Parts that the trace does not hold are left out.
FeedAccuracy feed_accuracy(const ServoTrace& trace, const nc::Interpretation& program, const machine::Machine& machine,
                           const std::vector<TracePart>& parts, const FeedAccuracyOptions& options);

}  // namespace camber::calib
