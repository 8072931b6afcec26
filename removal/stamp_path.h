#pragma once
// From the timed path to stamps, one tooth passing apart.
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "feedmodel/path_tracker.h"
#include "feedmodel/timed_path.h"
#include "machine/job.h"
#include "nc/move.h"
#include "removal/hole_moves.h"
#include "removal/stamp.h"

namespace camber::removal {

enum class RunKind : std::uint8_t { milling, drilling, tapping };

/// Stamps from ... from + count - 1 are cut by one tool, one after the other.
struct ToolRun {
  int tool = 0;
  std::size_t from = 0, count = 0;
  RunKind kind = RunKind::milling;
};

/// When a rapid begins; rapids too short to hold a sample take the time of the next one.
struct RapidStart {
  std::uint32_t move = 0;  ///< index into Interpretation::moves
  double t_s = 0;
};

struct StampPath {
  std::vector<Stamp> stamps;
  std::vector<ToolRun> runs;
  std::vector<RapidStart> rapids;  ///< in order
};

/// True for a move of the job's operations.
bool in_operations(const nc::Interpretation& program, const nc::Move& move, const machine::Operations& operations);

/// Which moves are milled: lines and arcs of the job's operations whose place in the work frame is known. Drilling
/// cycles are not among them (removal/hole_moves).
std::vector<bool> selected_moves(const nc::Interpretation& program, const machine::Operations& operations);

/// Takes the samples of predict_feed in order and sets a stamp every tooth passing, 60 / (rpm * flutes) s, while
/// the actual position lies on a selected move. Stamps that have not moved since the one before are left out.
/// Every selected move's tool must be in `tools` and its spindle must turn.
///
/// Moves that make holes get stamps as well, in runs of their own: on the commanded axis, and one at the commanded
/// bottom, where a cycle waits for the axis.
class StampBuilder {
 public:
  StampBuilder(const nc::Interpretation& program, const std::map<int, machine::Tool>& tools, std::vector<bool> selected,
               std::vector<HoleMove> holes = {});
  void add(std::span<const feedmodel::TimedSample> samples);
  StampPath take();

 private:
  void add(const feedmodel::TimedSample& sample);
  void stamp_at(double t_s, const feedmodel::TimedSample& sample, const feedmodel::PathPlace& place, int tool);
  void drill(const feedmodel::TimedSample& sample, const feedmodel::PathPlace& place);
  void finish_hole(std::uint32_t move, double t_s);
  void hole_stamp(std::uint32_t move, double share, double t_s);
  void append(const Stamp& stamp, int tool, RunKind kind);
  bool makes_hole(std::uint32_t move) const { return !holes_.empty() && removal::makes_hole(holes_[move]); }
  double passing_s(std::uint32_t move) const;

  const nc::Interpretation& program_;
  const std::map<int, machine::Tool>& tools_;
  std::vector<bool> selected_;
  std::vector<HoleMove> holes_;
  feedmodel::PathTracker tracker_;
  StampPath path_;
  feedmodel::TimedSample last_;
  bool have_last_ = false, cutting_ = false;
  double next_s_ = 0;
  std::uint32_t next_move_ = 0;  ///< whose beginning was not met yet
  std::uint32_t next_hole_ = 0;  ///< move whose hole, if any, is not finished yet
  double hole_share_ = 0;        ///< of next_hole_'s length, at the last sample
};

}  // namespace camber::removal
