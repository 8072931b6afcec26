#pragma once
// The kinematic chain of a machine as JSON.
#include <string>

#include "kinematics/explain.h"

namespace camber::report {

/// With a line end. `machine`: its file.
std::string kinematics_json(const kinematics::Explanation& explanation, const std::string& machine);

}  // namespace camber::report
