#pragma once
// Load of the spindle by tool and line, for who sets limits of a load monitor; spindle_load.csv.
#include <string>
#include <vector>

#include "machine/job_file.h"
#include "simulate/predict.h"

namespace camber::report {

/// The heaviest turn of the spindle in a line of the program. Power and torque are means over that turn, for cutting
/// alone: what a monitor shows above the idle spindle, before the spindle's own losses.
struct SpindleLoad {
  int tool = 0;
  std::size_t line = 0;
  double power_W = 0, torque_Nm = 0;
};

/// A row for each tool and line that removes material, by tool in the order of its first cut, then by line.
std::vector<SpindleLoad> spindle_loads(const machine::Job& job, const simulate::SimulatedProgram& program,
                                       const simulate::Prediction& prediction);

/// Columns tool,line,power_W,torque_Nm. Throws InputError [file-unwritable].
void write_spindle_load_csv(const std::string& path, const std::vector<SpindleLoad>& loads);

}  // namespace camber::report
