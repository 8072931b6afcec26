#pragma once
// Contour error of tool poses: distance of tip and axis from the path of poses that the control commands.
#include <cstddef>
#include <deque>

#include "base/tool_pose.h"

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

}  // namespace camber::feedmodel
