#pragma once
// What F counts, and what it asks of the rotary axes, line by line in a program with rotary motion.
#include <memory>
#include <vector>

#include "feedmodel/segment.h"
#include "machine/machine.h"
#include "nc/move.h"

namespace camber::calib {

struct LineFeed {
  std::shared_ptr<const feedmodel::Turn> turn;  ///< null: a line without motion
  bool rotary_alone = false;                    ///< X, Y and Z rest
  bool turns = false;                           ///< a rotary axis moves
  bool cutting = false;
  /// Along the path, /s: mm, or degrees where only rotary axes move. 0 for rapids.
  double feed_per_s = 0;
  double length = 0;                    ///< of the same path
  Vec3 asked_deg_per_s = Vec3::Zero();  ///< of a, b, c; infinite for those that turn in a rapid
};

/// Of the last move of each line, by its 1-based number. Requires feedmodel::has_rotary_motion.
std::vector<LineFeed> feeds_of_lines(const nc::Interpretation& program, const machine::Machine& machine);

}  // namespace camber::calib
