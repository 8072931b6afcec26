#include "api/commands/explain_kinematics.h"

#include "base/json.h"
#include "machine/job_file.h"
#include "machine/toml_table.h"

namespace camber::api {
namespace {

machine::Machine machine_of(const std::string& path, Diagnostics& found) {
  const auto file = machine::read_toml(path, "a machine description or a job", found);
  found.throw_if_errors();
  const machine::TomlTable top = machine::TomlTable::top(*file, found);
  const bool job = top.has("machine") || top.has("program");
  return job ? machine::read_job(path, found).machine : machine::read_machine(path, found);
}

}  // namespace

ExplainedKinematics explain_kinematics(const machine::Machine& machine) {
  if (!machine.kinematics.given())
    fail_on_file(machine.path, "[kinematics] is missing; a chain from the part to the spindle was expected",
                 "kinematics-missing");
  return {machine.path, kinematics::explain(machine)};
}

ExplainedKinematics explain_kinematics(const std::string& path, Diagnostics& found) {
  return explain_kinematics(machine_of(path, found));
}

std::string explained_kinematics_json(const ExplainedKinematics& explained) {
  const kinematics::Explanation& e = explained.explanation;
  Json axes = Json::array();
  for (const kinematics::AxisExplanation& axis : e.axes)
    axes.push_back({{"axis", std::string(1, axis.letter)},
                    {"axis_type", axis.rotary ? "rotary" : "linear"},
                    {"carried_by", axis.table ? "table" : "head"},
                    {"positive", axis.motion},
                    {"limits", axis.limits}});
  const Json report = {{"machine", explained.machine}, {"machine_type", e.type}, {"axes", axes}, {"reach", e.reach}};
  return report.dump(2) + "\n";
}

}  // namespace camber::api
