#pragma once
// The programmed path stamp by stamp, for those who do not keep all of it.
#include <cstddef>
#include <functional>
#include <vector>

#include "removal/tool_path.h"

namespace camber::removal {

/// A stamp of nominal_path() and its number there; of `run` the count is not known yet.
using TakeNominal = std::function<void(const ToolRun& run, std::size_t number, const Stamp& stamp)>;

/// Gives all stamps of nominal_path() in order, and returns its runs. Called twice it gives the same.
std::vector<ToolRun> follow_nominal_path(const nc::Interpretation& program, const std::vector<bool>& selected,
                                         const StampPath& path, const kinematics::PartPath* rotary,
                                         const TakeNominal& take);

}  // namespace camber::removal
