#pragma once
// Tool path for material removal: stamps one tooth passing apart, and the moves that make holes.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "base/tool_pose.h"
#include "feedmodel/part_tracking.h"
#include "feedmodel/path_tracker.h"
#include "feedmodel/timed_path.h"
#include "machine/simulation_settings.h"
#include "machine/tool.h"
#include "nc/move.h"

namespace camber::removal {

/// The cutter at one tooth passing.
struct Stamp {
  double t_s = 0;
  ToolPose pose;
  Vec3 feed_per_tooth_mm = Vec3::Zero();  ///< motion since the stamp before, one tooth passing earlier
  double fraction = 0;                    ///< share of `move`'s length at which the tip stands, 0 to 1
  bool first = false;                     ///< after a rapid, a dwell or a tool change: no previous tooth passing
  std::uint32_t move = 0;  ///< index into Interpretation::moves, where the tip is (not what is commanded)
};

/// Motion of the tool since the stamp before, in the tool's frame.
///
/// Feed per tooth is a field where the tool turns against the part: f(p) = f_tip + omega x (p - tip), omega the turn
/// from tooth passing to tooth passing.
struct ToothMotion {
  Vec3 tip_mm = Vec3::Zero();
  Vec3 turn_rad = Vec3::Zero();  ///< rotation vector

  ToothMotion() = default;
  ToothMotion(const Vec3& tip, const Vec3& turn = Vec3::Zero()) : tip_mm(tip), turn_rad(turn) {}
  /// Motion of the point p of the tool, given from the tip.
  Vec3 at(const Vec3& p) const {
    const Vec3& w = turn_rad;
    return tip_mm + Vec3(w.y() * p.z() - w.z() * p.y(), w.z() * p.x() - w.x() * p.z(), w.x() * p.y() - w.y() * p.x());
  }
};
/// Motion of stamps[k] in the tool's frame; the first stamp of a run turns as the next one does.
ToothMotion motion_in_tool(std::span<const Stamp> stamps, std::size_t k);

/// Precondition of code with "upright" in its name or namespace.
inline bool all_upright(std::span<const Stamp> stamps) {
  return std::ranges::all_of(stamps, [](const Stamp& s) { return s.pose.upright(); });
}

enum class HoleMove : std::uint8_t {
  none,        ///< not of a hole, or not of the job's operations
  drilled,     ///< straight down: carved, with chips and forces
  tapped,      ///< G74, G84: carved, without chips and forces
  way_out,     ///< fed straight up out of the hole: nothing to cut
  not_carved,  ///< G87 (bored upwards, from below) and cycles along another axis than the tool's
};
constexpr bool makes_hole(HoleMove m) { return m == HoleMove::drilled || m == HoleMove::tapped; }

/// One per move of the program. A cycle's feed moves count for every cutter; of moves outside cycles, straight ones
/// up and down count where the job says that the tool is a drill (cycles written out by a CAM program).
std::vector<HoleMove> hole_moves(const nc::Interpretation& program, const machine::Operations& operations,
                                 const std::map<int, machine::Tool>& tools);

/// Number of holes; pecks at one position of one block are one hole.
struct HoleCount {
  std::size_t drilled = 0, tapped = 0;
};
HoleCount count_holes(const nc::Interpretation& program, const std::vector<HoleMove>& holes);

enum class RunKind : std::uint8_t { milling, drilling, tapping };

/// Stamps from ... from + count - 1 are consecutive cuts of one tool.
struct ToolRun {
  int tool = 0;
  std::size_t from = 0, count = 0;
  RunKind kind = RunKind::milling;
};

/// When a rapid begins; rapids without a sample have the time of the next one.
struct RapidStart {
  std::uint32_t move = 0;  ///< index into Interpretation::moves
  double t_s = 0;
};

struct StampPath {
  std::vector<Stamp> stamps;
  std::vector<ToolRun> runs;
  std::vector<RapidStart> rapids;  ///< in order
};

/// The stamps of a path one by one, for those who do not keep all of them: a stamp and its number in the path; of `run`
/// the count is not known yet.
using StampSink = std::function<void(const ToolRun& run, std::size_t number, const Stamp& stamp)>;

/// Returns the stamps whose number `keep` accepts, in runs of consecutive ones.
StampPath stamps_where(const StampPath& path, const std::function<bool(std::size_t)>& keep);

/// Returns the same tooth passings on the programmed moves, without servo lag and corner rounding: each milling stamp
/// is placed where the programmed path is nearest to the axes, so that feed marks and cusps stay in step. Where the
/// axes cut a corner, and at the ends of a cut, stamps no farther apart are added: every `selected` move is covered
/// completely. Stamps of holes stay as they are. `path`: path of the same program; its `rapids` are left out.
/// `rotary`: path of a program with rotary motion, whose moves_in_part() then are `program`.
StampPath nominal_path(const nc::Interpretation& program, const std::vector<bool>& selected, const StampPath& path,
                       const kinematics::PartPath* rotary = nullptr);

/// True for a move of the job's operations.
bool in_operations(const nc::Interpretation& program, const nc::Move& move, const machine::Operations& operations);

/// Milling moves: lines and arcs of the job's operations with a known position in the work frame. Drilling
/// cycles are not among them (hole_moves()).
std::vector<bool> selected_moves(const nc::Interpretation& program, const machine::Operations& operations);

/// Takes the samples of predict_feed in order and places a stamp at every tooth passing, 60 / (rpm * flutes) s, while
/// the actual position lies on a selected move. Stamps without motion since the previous one are skipped.
/// Every selected move's tool must be in `tools` and its spindle must turn.
///
/// Moves that make holes get stamps as well, in runs of their own: on the commanded axis, and one at the commanded
/// bottom, where a cycle waits for the axis.
///
/// `rotary`: of a program with rotary motion, of which `program` then is the moves_in_part(), and samples are those of
/// feedmodel::PartSamples; a stamp has the pose of the actual axes, and is placed where the tool turns as well.
///
/// `sink` (may be empty) gets every stamp; none but the last is kept then, and take() has the runs and rapids.
class StampBuilder {
 public:
  StampBuilder(const nc::Interpretation& program, const std::map<int, machine::Tool>& tools, std::vector<bool> selected,
               std::vector<HoleMove> holes = {}, const kinematics::PartPath* rotary = nullptr, StampSink sink = {});
  StampBuilder(const StampBuilder&) = delete;
  StampBuilder& operator=(const StampBuilder&) = delete;
  void add(std::span<const feedmodel::TimedSample> samples);
  void add(const feedmodel::PartSamples& samples);
  StampPath take();

 private:
  void add(const feedmodel::TimedSample& sample);
  feedmodel::PathMeasure measure_of(const kinematics::PartPath* rotary) const;
  /// Between the last sample and this one.
  feedmodel::ToolPlace tool_between(double u) const;
  ToolPose pose_at(const feedmodel::TimedSample& sample, const feedmodel::PathPlace& place, double u) const;
  double fraction_of(const ToolPose& pose, double u, std::uint32_t move, double from, double to) const;
  void stamp_at(double t_s, const feedmodel::TimedSample& sample, const feedmodel::PathPlace& place, int tool);
  void drill(const feedmodel::TimedSample& sample, const feedmodel::PathPlace& place);
  void finish_hole(std::uint32_t move, double t_s);
  void hole_stamp(std::uint32_t move, double fraction, double t_s);
  void append(const Stamp& stamp, int tool, RunKind kind);
  bool makes_hole(std::uint32_t move) const { return !holes_.empty() && removal::makes_hole(holes_[move]); }
  double passing_s(std::uint32_t move) const;

  const nc::Interpretation& program_;
  const std::map<int, machine::Tool>& tools_;
  std::vector<bool> selected_;
  std::vector<HoleMove> holes_;
  const kinematics::PartPath* rotary_;
  StampSink sink_;
  feedmodel::ToolPlace tool_, last_tool_;  ///< place of the tool on `rotary` at this sample and at the last one
  feedmodel::PathTracker tracker_;
  StampPath path_;
  feedmodel::TimedSample last_;
  bool have_last_ = false, cutting_ = false;
  double next_s_ = 0;
  std::uint32_t next_move_ = 0;  ///< whose beginning was not met yet
  std::uint32_t next_hole_ = 0;  ///< move whose hole, if any, is not finished yet
  double hole_fraction_ = 0;     ///< share of next_hole_'s length that is done at the last sample
};

/// A stamp and its number in the path; of `run` the count is not known yet.
using StampSink = std::function<void(const ToolRun& run, std::size_t number, const Stamp& stamp)>;

/// While it lives, a StampBuilder of this thread gives its stamps to `sink`, and keeps none but the last: take() has
/// the runs and rapids. Only one may live in a thread; `sink` must outlive it.
class StampSinkScope {
 public:
  explicit StampSinkScope(const StampSink& sink);
  ~StampSinkScope();
  StampSinkScope(const StampSinkScope&) = delete;
  StampSinkScope& operator=(const StampSinkScope&) = delete;
};

/// A stamp of nominal_path() and its number there; of `run` the count is not known yet.
using TakeNominal = StampSink;

/// Passes all stamps of nominal_path() to `take`, in order, and returns its runs. A second call gives the same result.
std::vector<ToolRun> follow_nominal_path(const nc::Interpretation& program, const std::vector<bool>& selected,
                                         const StampPath& path, const kinematics::PartPath* rotary,
                                         const TakeNominal& take);

/// Does what follow_nominal_path() does for a path whose stamps come one by one.
class NominalFollower {
 public:
  NominalFollower(const nc::Interpretation& program, const std::vector<bool>& selected,
                  const kinematics::PartPath* rotary, TakeNominal take);
  ~NominalFollower();
  NominalFollower(const NominalFollower&) = delete;
  NominalFollower& operator=(const NominalFollower&) = delete;
  /// All stamps of the path in order, with their runs.
  void add(const ToolRun& run, const Stamp& stamp);
  /// Gives the rest, and returns the runs.
  std::vector<ToolRun> finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace camber::removal
