#pragma once
// Times from logs and tables beside servo traces: stretches of feed moves as the fit of the limits takes them.
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "calib/fit_limits.h"
#include "calib/stretch.h"
#include "nc/move.h"

namespace camber::calib {

/// The logged stretches of one program: one for each geometry, in the order of the program, each with the rapids
/// around it, a rest before.
struct LoggedLines {
  std::string program_name;
  std::unique_ptr<nc::Interpretation> program;  ///< these stretches alone; `lines` refers to it
  TimedLines lines;
};

/// Of every `keep_back_every`-th stretch the time is held out. `count`: of the parts before, which goes on, so that no
/// two parts are of one group.
std::vector<LoggedLines> logged_lines(const std::vector<StretchRun>& runs, int keep_back_every, std::size_t& count);

}  // namespace camber::calib
