#pragma once
// The levers of a compensation by their names, as a job and the command line have them.
#include <string>
#include <string_view>
#include <vector>

#include "machine/job.h"

namespace camber::machine {

inline constexpr std::string_view kWantedLevers = "a list of \"shift\", \"feed\" and \"passes\"";

struct LeverNames {
  std::vector<Lever> levers;
  std::vector<std::string> errors;  ///< "levers names "speed"; ... was expected"; empty: none
};

/// The levers of `names`; "shift" must be among them.
LeverNames levers_of(const std::vector<std::string>& names);

}  // namespace camber::machine
