#pragma once
// camber adapt: the feeds of a program by the loads of its cut.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "adapt/feed_chooser.h"
#include "adapt/load.h"
#include "base/diagnostics.h"
#include "machine/job_file.h"
#include "simulate/predict_path.h"
#include "simulate/setup.h"

namespace camber::adapt {

// Spindle speeds that keep the limit on chatter, in the text of a program.

/// One tool at one programmed spindle speed.
struct SpeedChange {
  int tool = 0;
  double before_rpm = 0, after_rpm = 0;  ///< the same: not changed
  bool measured = false;                 ///< the tool's modes are given; else its beam's, with a usual damping
  std::size_t line = 0, new_line = 0;    ///< worst tooth passing, of the given and of the new program
  double margin_before = 0, margin_after = 0;
  double chatter_hz = 0;     ///< heard at the worst passing of the given program
  double depth_mm = 0;       ///< axial depth there
  double kept_depth_mm = 0;  ///< axial depth that would keep the limit there at the programmed speed
  double best_rpm = 0;       ///< speed with the least margin of those that may be used; 0: not looked for
  double best_depth_mm = 0;  ///< axial depth that would keep the limit at it
  double advised_rpm = 0;    ///< speed that keeps the limit; 0: none, or not looked for
  double probability = 0;    ///< that the new program chatters, with the modes at their errors
  bool kept = false;         ///< the limit is kept
  std::string reason{};      ///< why the speed that keeps the limit is not in the text; empty: it is, or there is none
};

/// For each tool at each programmed speed: its greatest margin, and the speed that would keep the job's limit.
std::vector<SpeedChange> find_speed_changes(const machine::Job& job, const simulate::SimulatedProgram& program,
                                            std::span<const simulate::StampLoad> loads);

/// A program with other S words, and F words that keep the chips.
struct SpeedText {
  std::string text;
  std::vector<std::uint32_t> block_of_line;  ///< see nc::Emission
};

/// Sets advised speeds as far as the text allows; `changes` get after_rpm and reason. Nothing is changed: no text.
SpeedText emit_speed_changes(const machine::Job& job, const simulate::SimulatedProgram& program,
                             std::vector<SpeedChange>& changes);

struct AdaptOptions {
  /// The limits are scaled, all by the same factor, until the program takes no longer than this.
  std::optional<double> time_limit_s{};
  bool sweep = false;  ///< also the time for other limits
  simulate::Progress progress{};
};

struct LoadFigure {
  LoadLimit limit;
  double max_before = 0, max_after = 0;
  double max_elsewhere = 0;  ///< after, outside the blocks that remain over the limit
};

/// Why a block remains over a limit.
enum class OverReason : std::uint8_t {
  lowest_feed,   ///< it has the lowest feed
  plunge,        ///< feeds along the tool's axis are not changed
  not_editable,  ///< the text does not allow its feed to be changed
  control,       ///< the control does not slow down in time
  highest_feed   ///< chip_min_mm: a limit or the highest feed keeps the chip thinner
};
std::string_view to_string(OverReason reason);

/// A load of a block beyond its limit by more than kOverLimit.
struct OverLimit {
  std::size_t line = 0, new_line = 0;  ///< line of the given and of the emitted program, the worst place
  LoadLimit limit;
  double value = 0, feed_mm_per_s = 0;  ///< the greatest load there, and the actual feed at it
  OverReason reason = OverReason::lowest_feed;
};
constexpr double kOverLimit = 1.02;
/// A peak between this and kOverLimit of the limit is what is aimed at.
constexpr double kUnderLimit = 0.95;

/// Time for other limits, by the model of the loads.
struct SweepRow {
  double factor = 1;  ///< factor on the limits
  double time_s = 0;
  std::size_t blocks = 0;             ///< number of blocks of the program
  double constant_feed_mm_per_s = 0;  ///< the greatest single feed that keeps the limits; 0: none from the lowest on
  double constant_time_s = 0;         ///< with it
};

/// Values along the path, one per cell.
struct PathTrace {
  std::vector<double> along_mm;                                   ///< path length at the cell's end, all cutting moves
  std::vector<std::size_t> line;                                  ///< line of the given program
  std::vector<double> feed_before_mm_per_s, feed_after_mm_per_s;  ///< commanded
  std::vector<double> speed_before_mm_per_s, speed_after_mm_per_s;  ///< actual, greatest
  std::vector<std::vector<double>> load_before, load_after;         ///< one row per limit but chip_min
};

struct AdaptResult {
  std::string text;
  std::vector<std::uint32_t> block_of_line;  ///< see nc::Emission
  bool good = false;                         ///< no load exceeds a limit but in the blocks of `over`
  bool in_time = true;                       ///< AdaptOptions::time_limit_s is kept
  std::vector<std::string> doubts;           ///< why the figures are not reliable
  std::vector<LoadFigure> loads;
  std::vector<OverLimit> over;  ///< by line
  double limit_factor = 1;      ///< by which time_limit_s scaled the limits
  double time_before_s = 0, time_after_s = 0;
  double cutting_time_before_s = 0, cutting_time_after_s = 0;
  double milling_time_before_s = 0, milling_time_after_s = 0;  ///< machine time of the job's operations alone
  std::size_t blocks_before = 0, blocks_after = 0, blocks_changed = 0;
  double constant_feed_mm_per_s = 0, constant_time_s = 0;  ///< see SweepRow, for the limits
  double constant_milling_time_s = 0;
  int predictions = 0;              ///< number of predictions of the emitted program
  double chatter_limit = 0;         ///< greatest margin; 0: no limit
  std::vector<SpeedChange> speeds;  ///< with it: each tool at each speed, in the order of the path
  std::vector<SweepRow> sweep;      ///< ascending factor
  PathTrace trace;
};

/// One prediction of the given program with a rigid tool tells both parts of every load (LoadCurve); feeds are chosen
/// and emitted with the feed model in the loop (FeedChooser); a prediction of the emitted program in the job's coupling
/// judges it, and corrects the loads where it differs from what was expected, at most kMaxPredictions times.
/// Throws InputError.
AdaptResult adapt(const machine::Job& job, Diagnostics& diagnostics, const AdaptOptions& options);
constexpr int kMaxPredictions = 3;

}  // namespace camber::adapt
