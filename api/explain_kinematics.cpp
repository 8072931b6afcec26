#include "camber/explain_kinematics.h"

#include "api/job.h"
#include "kinematics/explain.h"
#include "machine/toml_table.h"
#include "report/kinematics_json.h"

namespace camber {
namespace {

bool is_job(const std::string& path) {
  Diagnostics found;
  const auto file = machine::read_toml(path, "a machine description or a job", found);
  found.throw_if_errors();
  const machine::TomlTable top = machine::TomlTable::top(*file, found);
  return top.has("machine") || top.has("program");
}

KinematicsExplanation explained(const machine::Machine& machine, const Diagnostics& said) {
  if (!machine.kinematics.given())
    fail_on_file(machine.path, "[kinematics] is missing; a chain from the part to the spindle was expected",
                 "kinematics-missing");
  const kinematics::Explanation found = kinematics::explain(machine);
  KinematicsExplanation out;
  out.machine_type = found.type;
  out.drawing = found.drawing;
  for (const kinematics::AxisExplanation& axis : found.axes)
    out.axes.push_back({axis.letter, axis.rotary, axis.table, axis.motion, axis.limits});
  out.reach = found.reach;
  out.diagnostics = said.all();
  out.text = kinematics::to_text(found, machine.path);
  out.json = report::kinematics_json(found, machine.path);
  return out;
}

}  // namespace

KinematicsExplanation v0::explain_kinematics(const Machine& machine) {
  return explained(machine.impl().machine, machine.impl().found);
}

KinematicsExplanation v0::explain_kinematics(const Job& job) {
  return explained(job.impl().job.machine, job.impl().found);
}

KinematicsExplanation v0::explain_kinematics(const std::string& path) {
  return is_job(path) ? explain_kinematics(read_job(path)) : explain_kinematics(read_machine(path));
}

}  // namespace camber
