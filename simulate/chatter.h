#pragma once
// Chatter along a path: each tooth passing's depth over the depth at which it becomes unstable.
//
// The chips of a passing (deflection/chip_arc) have the mean directional matrix of one arc: its centre, its angle and
// its depth follow from the integrals of 1, cos 2 phi and sin 2 phi, int e^(2 i phi) dphi = e^(2 i centre) sin(angle)
// over an arc. Of this cut the critical depth is looked up (dynamics/stability_table.h).
#include <map>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "base/diagnostics.h"
#include "dynamics/stability_table.h"
#include "dynamics/tool_lobes.h"
#include "simulate/predict_path.h"

namespace camber::simulate {

/// The tables of a job's tools at the speeds of its programs, made where they are first asked for.
class CriticalDepths {
 public:
  /// `job`: the same at every call.
  dynamics::StabilityTable& at(const machine::Job& job, int tool, double speed_rpm, bool upright);

 private:
  std::map<int, std::vector<machine::Mode>> modes_;  ///< by tool
  std::map<std::tuple<int, double, bool>, dynamics::StabilityTable> tables_;
};

/// Finds the margin of each tooth passing in milling; holes have a margin of 0. Modes of the work count where the tool
/// is upright. Passings are invalid above a margin of 1 where the tool's modes are given, and else where the
/// probability of chatter is above kSureOfChatter: a guessed damping alone says little. `depths`: of this job.
ChatterMargins find_chatter(const machine::Job& job, const SimulatedProgram& program, std::span<const StampLoad> loads,
                            CriticalDepths& depths);
constexpr double kSureOfChatter = 0.9;

/// A warning [chatter] for each operation with invalid passings, at its worst line: margin, frequency, probability,
/// other lines, and the speed or depth that would be stable.
void warn_of_chatter(const SimulatedProgram& program, const ChatterMargins& margins, Diagnostics& diagnostics);

/// Critical depths of an operation's worst cut from half its speed to the spindle's limit, twice the speed at most.
std::vector<dynamics::LobePoint> lobes_of(const machine::Job& job, const ChatterOperation& operation);

/// The margin of an operation's worst cut with one property of all modes one standard error down and up.
struct MarginEffect {
  std::string property;      ///< "frequency"
  double error = 0;          ///< standard deviation of its logarithm
  double low = 0, high = 0;  ///< margins, ascending
};
std::vector<MarginEffect> margin_effects(const machine::Job& job, const ChatterOperation& operation);

/// One sentence for an operation: "T1 at S8000: margin 0.42 ...".
std::string chatter_sentence(const ChatterOperation& operation);

}  // namespace camber::simulate
