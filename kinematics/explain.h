#pragma once
// A machine's kinematic chain in words.
#include <string>
#include <vector>

#include "machine/machine_model.h"

namespace camber::kinematics {

struct AxisExplanation {
  char letter = 0;  ///< X Y Z A B C
  bool rotary = false;
  bool table = false;  ///< carries the part; else the spindle
  std::string motion;  ///< what a positive word moves which way, one sentence
  std::string limits;  ///< travel, speed, acceleration, drive, clamps as far as given; may be empty
};

struct Explanation {
  std::string type;                   ///< "table-table", "head-table", "nutating head-table" ...
  std::vector<std::string> drawing;   ///< the chain, a line for each member
  std::vector<AxisExplanation> axes;  ///< from the part to the spindle
  std::vector<std::string> reach;     ///< sentences on the directions of the tool
};

/// Requires machine.kinematics.given().
Explanation explain(const machine::Machine& machine);

/// The explanation as printed: drawing, sentences, limits. UTF-8.
std::string to_text(const Explanation& explanation, const std::string& machine_path);

}  // namespace camber::kinematics
