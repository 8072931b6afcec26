#pragma once
// Predicted time of a path, and deviation of the axes from the reference path.
#include <vector>

#include "feedmodel/timed_path.h"
#include "machine/machine.h"
#include "nc/interpreter.h"

namespace camber::repath {

struct ContourFigures {
  double time_s = 0;  ///< of the whole program
  double cutting_time_s = 0;
  double contour_max_mm = 0;  ///< distance of the predicted axes from the path that was meant, while cutting
  double contour_rms_mm = 0;  ///< over time
  std::vector<float> move_s;  ///< how long each move takes, to within the control's period; of a program against itself
};

/// The path that was meant: its chains of cutting moves, each with the rapid that leads to it.
class MeantPath {
 public:
  explicit MeantPath(const nc::Interpretation& meant);

 private:
  friend class Follower;
  std::vector<std::size_t> first_;  ///< of each chain's points; behind the last one their number
  std::vector<Vec3> points_;
  std::vector<double> along_;  ///< up to each point, from its chain's first
};

/// Predicts `program` on the machine, against the path that was meant. Both have the same chains of cutting moves, one
/// after another; the nearest point is looked for along the chain, no farther than a few millimetres ahead.
/// `moves`: ContourFigures::move_s is wanted.
ContourFigures contour_figures(const nc::Interpretation& program, const MeantPath& meant,
                               const machine::Machine& machine, bool moves = false);
ContourFigures contour_figures(const nc::Interpretation& program, const nc::Interpretation& meant,
                               const machine::Machine& machine);

}  // namespace camber::repath
