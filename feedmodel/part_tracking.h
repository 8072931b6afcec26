#pragma once
// Samples of programs with rotary motion in the part's frame: poses of the tool, and their places on the path.
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "feedmodel/path_tracker.h"
#include "feedmodel/timed_path.h"
#include "kinematics/part_path.h"

namespace camber::feedmodel {

/// Joints and tool of one sample, actual.
struct ToolPlace {
  ToolPose tool;  ///< pose in the frame of the program's X Y Z
  kinematics::Joints joints;
};

/// Samples of predict_joints with the tip on the part for X, Y and Z: commanded and actual place, actual velocity (the
/// mean over the period before).
class PartSamples {
 public:
  /// Number of entries that samples() and tools() then hold, until the next call.
  void take(std::span<const TimedSample> samples, std::span<const JointSample> joints);
  std::span<const TimedSample> samples() const { return samples_; }
  /// The samples that were taken.
  std::span<const TimedSample> axes() const { return axes_; }
  std::span<const JointSample> joints() const { return joints_; }
  std::span<const ToolPlace> tools() const { return tools_; }

 private:
  std::span<const TimedSample> axes_;
  std::span<const JointSample> joints_;
  std::vector<TimedSample> samples_;
  std::vector<ToolPlace> tools_;
  std::optional<Vec3> last_tip_mm_;
  double last_s_ = 0;
};

/// predict_joints in the part's frame, run by run. `moves_of_axes`: of a kinematics::MachineProgram that turns.
using PartSink = std::function<void(const PartSamples&)>;
FeedSummary predict_on_part(const nc::Interpretation& moves_of_axes, const machine::Machine& machine,
                            const PartSink& sink);

/// Does what closest_on_move does, for a tool and the angles of its axes, of which 1 rad counts as PartPath::kLever_mm:
/// the place where a tip that stands still is turned by other blocks. `in_part`: path.moves_in_part().
PathPlace closest_on_part(const kinematics::PartPath& path, const nc::Interpretation& in_part, std::uint32_t move,
                          const ToolPlace& is, double from_u, double to_u);

}  // namespace camber::feedmodel
