#pragma once
// The work of camber check --explain-kinematics.
#include <string>

#include "base/diagnostics.h"
#include "kinematics/explain.h"

namespace camber::api {

struct ExplainedKinematics {
  std::string machine;  ///< path of its file
  kinematics::Explanation explanation;
};

/// Throws InputError where there is no [kinematics].
ExplainedKinematics explain_kinematics(const machine::Machine& machine);

/// `path`: machine.toml, or a job.toml, whose machine counts. Throws InputError, also where there is no [kinematics].
ExplainedKinematics explain_kinematics(const std::string& path, Diagnostics& found);

/// The explanation as JSON text, with a line end.
std::string explained_kinematics_json(const ExplainedKinematics& explained);

}  // namespace camber::api
