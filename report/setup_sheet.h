#pragma once
// The set-up sheet: what a setter needs at the machine, as a page that prints on A4.
#include <string>
#include <vector>

#include "feedmodel/cycle_time.h"
#include "machine/job_file.h"
#include "nc/move.h"
#include "nc/program.h"
#include "nc/summary.h"

namespace camber::report {

struct SheetProgram {
  const nc::Program& text;
  const nc::Interpretation& moves;
  const nc::Summary& summary;
  feedmodel::CycleTime time;
};

struct SetupSheet {
  const machine::Job& job;
  std::vector<SheetProgram> programs;  ///< in the order in which they run
  std::vector<std::string> warnings;   ///< warnings of the checks
};

/// Blank and program zero in two views, every tool drawn to one scale with its numbers (length and radius offset as the
/// programs call them, speeds, feeds, depth, time), work offsets, the space that tips move in, limits of the machine
/// beside what the programs ask for, times, and what is assumed. Same input, same bytes: no date.
std::string setup_sheet_html(const SetupSheet& sheet);

}  // namespace camber::report
