#include "report/kinematics_json.h"

#include "base/json.h"

namespace camber::report {

std::string kinematics_json(const kinematics::Explanation& e, const std::string& machine) {
  Json axes = Json::array();
  for (const kinematics::AxisExplanation& axis : e.axes)
    axes.push_back({{"axis", std::string(1, axis.letter)},
                    {"axis_type", axis.rotary ? "rotary" : "linear"},
                    {"carried_by", axis.table ? "table" : "head"},
                    {"positive", axis.motion},
                    {"limits", axis.limits}});
  const Json report = {{"machine", machine}, {"machine_type", e.type}, {"axes", axes}, {"reach", e.reach}};
  return report.dump(2) + "\n";
}

}  // namespace camber::report
