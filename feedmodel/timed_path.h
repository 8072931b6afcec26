#pragma once
// The path in time: commanded and actual positions of the axes at every period of the control.
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>

#include "base/geometry.h"
#include "base/tool_pose.h"
#include "machine/machine_model.h"
#include "nc/move.h"

namespace camber::feedmodel {

/// Follows the poses in time. The pose on the commanded path that a sample is compared with is the nearest one, not
/// before that of the last sample; nearest by tip and axis together, where 1 rad of the axis counts as kAxisArmMm: a
/// tip that stands still has no other place.
class PoseContour {
 public:
  static constexpr double kAxisArmMm = 10;

  struct Error {
    double tip_mm = 0, axis_rad = 0;
  };
  Error operator()(const ToolPose& command, const ToolPose& actual);

 private:
  std::deque<ToolPose> commands_;  ///< commands from the nearest one of the last call on
};

/// Maximum and root mean square over samples.
struct PoseContourFigures {
  double tip_max_mm = 0, tip_rms_mm = 0, axis_max_rad = 0, axis_rms_rad = 0;
};

class PoseContourSum {
 public:
  void add(const PoseContour::Error& error);
  PoseContourFigures figures() const;

 private:
  PoseContourFigures sum_;  ///< sums of squares in place of the means
  std::size_t count_ = 0;
};

struct TimedSample {
  double t_s = 0;
  Vec3 command_mm = Vec3::Zero();         ///< position that the interpolator commands
  Vec3 position_mm = Vec3::Zero();        ///< predicted actual axes
  Vec3 velocity_mm_per_s = Vec3::Zero();  ///< predicted actual axes
  double feed_command_mm_per_s = 0;       ///< programmed feed of the commanded move (rapid: its top speed)
  std::uint32_t move = 0;                 ///< index of the move being commanded
};

/// Beside a TimedSample, in programs with rotary motion: there X, Y and Z of the sample are those of the machine.
struct JointSample {
  Vec3 command_rad = Vec3::Zero();                                      ///< a, b, c
  Vec3 position_rad = Vec3::Zero(), velocity_rad_per_s = Vec3::Zero();  ///< predicted actual axes
  ToolPose command_tool, tool;  ///< commanded and actual, in the frame of the program's X Y Z
  double feed_mm_per_s = 0;     ///< actual, of what F counts in the commanded move (FeedMeaning); degrees/s
};

struct FeedSummary {
  double time_s = 0;
  double cutting_time_s = 0;  ///< commanded time in G1, G2, G3
  std::size_t blocks = 0;     ///< blocks with motion
  /// Contour error of tip and axis in feed moves of a program with rotary motion.
  std::optional<PoseContourFigures> contour{};
};

/// Called with runs of samples in time order; memory does not grow with the path's duration.
using SampleSink = std::function<void(std::span<const TimedSample>)>;

/// Receives samples with the rotary axes, as many of the one as of the other.
using JointSampleSink = std::function<void(std::span<const TimedSample>, std::span<const JointSample>)>;

/// Plans the whole path, then follows it with the axes. Deterministic. Does not throw on valid input.
FeedSummary predict_feed(const nc::Interpretation& program, const machine::Machine& machine, const SampleSink& sink);

/// Does the same for a program with rotary motion. Requires has_rotary_motion (joint_map.h).
FeedSummary predict_joints(const nc::Interpretation& program, const machine::Machine& machine,
                           const JointSampleSink& sink);

}  // namespace camber::feedmodel
