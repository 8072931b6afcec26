#pragma once
// The kinematic chain of a machine in words.
#include <string>
#include <vector>

#include "camber/job.h"
#include "camber/machine.h"

namespace camber {
inline namespace v0 {

/// An axis of the chain.
struct ChainAxis {
  char letter = 0;       ///< X Y Z A B C
  bool rotary = false;   ///< else linear
  bool table = false;    ///< carries the part; else the spindle
  std::string positive;  ///< what a positive word moves which way, in words
  std::string limits;    ///< travel, speed, acceleration, drive, clamps as far as given; may be empty
};

struct KinematicsExplanation {
  std::string machine_type;               ///< "table-table", "head-table", "nutating head-table" ...
  std::vector<std::string> drawing;       ///< the chain, a line for each member
  std::vector<ChainAxis> axes;            ///< from the part to the spindle
  std::vector<std::string> reach;         ///< sentences on the directions of the tool
  std::vector<Diagnostic> diagnostics{};  ///< warnings found while reading the machine or the job
  std::string text;                       ///< as `camber check --explain-kinematics` prints it
  std::string json;                       ///< as it writes it with --json
};

/// Throws InputError [kinematics-missing] for a machine without [kinematics].
CAMBER_API KinematicsExplanation explain_kinematics(const Machine& machine);
/// The same for the machine of a job.
CAMBER_API KinematicsExplanation explain_kinematics(const Job& job);
/// The same for a file: machine.toml or job.toml.
CAMBER_API KinematicsExplanation explain_kinematics(const std::string& path);

}  // namespace v0
}  // namespace camber
