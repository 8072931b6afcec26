#include "camber/explain_kinematics.h"

#include "api/commands/explain_kinematics.h"
#include "api/job.h"

namespace camber {
namespace {

KinematicsExplanation explained(const machine::Machine& machine, const Diagnostics& said) {
  const api::ExplainedKinematics found = api::explain_kinematics(machine);
  KinematicsExplanation out;
  out.machine_type = found.explanation.type;
  out.drawing = found.explanation.drawing;
  for (const kinematics::AxisExplanation& axis : found.explanation.axes)
    out.axes.push_back({axis.letter, axis.rotary, axis.table, axis.motion, axis.limits});
  out.reach = found.explanation.reach;
  out.diagnostics = said.all();
  out.text = kinematics::to_text(found.explanation, found.machine);
  out.json = api::explained_kinematics_json(found);
  return out;
}

}  // namespace

KinematicsExplanation v0::explain_kinematics(const Machine& machine) {
  return explained(machine.impl().machine, machine.impl().found);
}

KinematicsExplanation v0::explain_kinematics(const Job& job) {
  return explained(job.impl().job.machine, job.impl().found);
}

}  // namespace camber
