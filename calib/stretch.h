#pragma once
// Stretches of consecutive feed moves with their measured durations.
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/diagnostics.h"
#include "base/geometry.h"
#include "nc/move.h"

namespace camber::calib {

/// Lines of the program from one rapid, dwell or tool change to the next, 1-based, both included; or a piece of such a
/// run, which begins or ends in motion.
struct FeedStretch {
  std::uint32_t line_first = 0, line_last = 0;
  std::size_t move_first = 0, move_end = 0;  ///< of the interpretation
  std::size_t run_first = 0, run_end = 0;    ///< moves of the whole run
  int tool = 0;
  std::int64_t geometry = 0;       ///< equal for stretches of one shape (copies at other places or depths)
  double first_u = 0, last_u = 1;  ///< where a piece begins on its first move and ends on its last: fractions of them

  bool begins_in_motion() const { return move_first > run_first || first_u > 0; }
  bool ends_in_motion() const { return move_end < run_end || last_u < 1; }
  /// Fraction of a move that lies in the stretch.
  double fraction_of(std::size_t move) const {
    return (move + 1 == move_end ? last_u : 1.0) - (move == move_first ? first_u : 0.0);
  }
};

/// A stretch and its time on the machine.
struct TimedStretch {
  FeedStretch stretch;
  double time_s = 0;
  double sigma_s = 0;      ///< uncertainty of the time
  double feed_factor = 1;  ///< feed override while it was cut
  /// Squares of the direction at its end less those at its begin, where the time is that of lagging axes: it is longer
  /// by their sum over the axes times the lag of each.
  Vec3 turn = Vec3::Zero();
};

/// A program and the times that were logged of its stretches.
struct StretchRun {
  std::string program_name;
  nc::Interpretation program;
  std::vector<TimedStretch> timed;
};

/// All stretches of feed moves of a program. Two are of one geometry, turned or mirrored, when they have as many
/// moves, the sorted lengths of which differ by less than 9 % of their mean, their programmed times by as
/// much, and the sorted corners by less than 0.05 rad, on average.
std::vector<FeedStretch> feed_stretches(const nc::Interpretation& program);

/// A piece of a run, by its moves and where it begins and ends on them. Its geometry is its own.
FeedStretch piece_of(const FeedStretch& run, const nc::Interpretation& program, std::size_t move_first,
                     std::size_t move_end, double first_u = 0, double last_u = 1);

/// Moves of the run around a stretch that decide how fast it begins and ends: 50 mm before and after it. [first, end)
struct StretchContext {
  std::size_t first = 0, end = 0;
};
StretchContext context_of(const FeedStretch& stretch, const nc::Interpretation& program);

/// A program of stretches, each within the moves around it and after a rest, those of one run that lie near each other
/// within the same moves.
class StretchProgram {
 public:
  /// with_rapids: a whole run has the rapids around it, before which a control may brake otherwise.
  StretchProgram(const nc::Interpretation& whole, bool with_rapids);
  /// Returns where its moves [first, end) are in the program. In the order of their moves.
  std::pair<std::size_t, std::size_t> add(const TimedStretch& timed);
  nc::Interpretation take() { return std::move(program_); }

 private:
  const nc::Interpretation& whole_;
  bool with_rapids_;
  nc::Interpretation program_;
  std::size_t run_first_ = 0, end_ = 0;  ///< of the moves added last
  double feed_factor_ = 0;
  std::size_t shift_ = 0;  ///< from moves of the whole program, modulo 2^64
};

/// Whether a file is a table of stretch times: its header names line_first or first_line.
bool is_stretch_table(const std::string& path);

/// Reads a CSV with the columns first_line, last_line and t_measured_median_s, or time_s (t_p10, t_p90 and n_parts tell
/// the error, where they are there). Lines are a whole stretch of the program or any piece of one; others are errors
/// [stretch-lines]. Throws
/// InputError: [stretch-column], [stretch-number], [stretch-lines], [file-missing].
std::vector<TimedStretch> read_stretch_table(const std::string& path, const nc::Interpretation& program);

/// One for each geometry: the first of its stretches, with the mean time and what it is known to.
/// The difference of a copy to the first is taken by the fraction of the programmed time.
/// In the order of the program.
std::vector<TimedStretch> one_for_each_geometry(const std::vector<TimedStretch>& all,
                                                const nc::Interpretation& program);

double programmed_length_mm(const FeedStretch& stretch, const nc::Interpretation& program);

/// Length / programmed feed over all moves of a stretch.
double programmed_time_s(const FeedStretch& stretch, const nc::Interpretation& program);
/// The same at the override at which it was cut.
double programmed_time_s(const TimedStretch& timed, const nc::Interpretation& program);
/// The moves of a program from `first` to `end` at an override.
std::vector<nc::Move> moves_at_override(const nc::Interpretation& program, std::size_t first, std::size_t end,
                                        double feed_factor);

}  // namespace camber::calib
