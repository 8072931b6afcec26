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
#include "removal/stamp.h"

namespace camber::removal {

/// Stamps from ... from + count - 1 are cut by one tool, one after the other.
struct ToolRun {
  int tool = 0;
  std::size_t from = 0, count = 0;
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

/// Which moves are cut: lines and arcs of the job's operations whose place in the work frame is known.
/// Drilling cycles are left out: a drill's point is no milling envelope.
std::vector<bool> selected_moves(const nc::Interpretation& program, const machine::Operations& operations);

/// Takes the samples of predict_feed in order and sets a stamp every tooth passing, 60 / (rpm * flutes) s, while
/// the actual position lies on a selected move. Stamps that have not moved since the one before are left out.
/// Every selected move's tool must be in `tools` and its spindle must turn.
class StampBuilder {
 public:
  StampBuilder(const nc::Interpretation& program, const std::map<int, machine::Tool>& tools,
               std::vector<bool> selected);
  void add(std::span<const feedmodel::TimedSample> samples);
  StampPath take() { return std::move(path_); }

 private:
  void add(const feedmodel::TimedSample& sample);
  void stamp_at(double t_s, const feedmodel::TimedSample& sample, const feedmodel::PathPlace& place, int tool);

  const nc::Interpretation& program_;
  const std::map<int, machine::Tool>& tools_;
  std::vector<bool> selected_;
  feedmodel::PathTracker tracker_;
  StampPath path_;
  feedmodel::TimedSample last_;
  bool have_last_ = false, cutting_ = false;
  double next_s_ = 0;
  std::uint32_t next_move_ = 0;  ///< whose beginning was not met yet
};

}  // namespace camber::removal
