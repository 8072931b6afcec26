#include "report/machine_view.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>

#include "base/json.h"

namespace camber::report {
namespace {

Json numbers_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

bool turns(const std::vector<PathRow>& rows) {
  return std::ranges::any_of(rows,
                             [](const PathRow& r) { return r.axis != Vec3::UnitZ() || r.rotary_rad != Vec3::Zero(); });
}

MachineView machine_view(const machine::Job& job, const std::vector<PathRow>& rows) {
  constexpr double kStep_mm = 0.5;
  MachineView out{job.machine, {}};
  for (const PathRow& row : rows) {
    const auto tool = job.tools.find(static_cast<int>(row.tool));
    if (tool == job.tools.end() || out.tools.contains(row.tool)) continue;
    out.tools[row.tool] = checks::tool_outline(tool->second, kStep_mm, 1e6);
  }
  return out;
}

Json chain_json(const machine::Machine& machine) {
  const machine::Kinematics& k = machine.kinematics;
  Json links = Json::array();
  for (std::size_t i = 0; i < k.chain.size(); ++i) {
    const char letter = k.chain[i];
    const bool rotary = letter < 'x';
    Json link = {{"axis", std::string(1, static_cast<char>(std::toupper(static_cast<unsigned char>(letter))))},
                 {"rotary", rotary},
                 {"table", i < k.table_axes}};
    if (rotary) {
      const machine::RotaryAxis& axis = machine.rotary[static_cast<std::size_t>(letter - 'a')];
      const double sense = axis.positive == machine::PositiveTurn::tool ? 1 : -1;
      link["direction"] = numbers_of(sense * axis.direction.normalized());
      link["point"] = numbers_of(axis.point_mm);
    } else {
      link["direction"] = numbers_of(Vec3::Unit(letter - 'x'));
    }
    links.push_back(std::move(link));
  }
  return {{"links", links}, {"gauge", numbers_of(k.gauge_point_mm)}, {"tool", numbers_of(k.tool_axis.normalized())}};
}

Json machine_json(const MachineView& view) {
  const auto rounded = [](double v) { return std::round(1e4 * v) / 1e4; };
  Json tools = Json::object();
  for (const auto& [number, rings] : view.tools) {
    Json outline = Json::array();
    for (const checks::OutlineRing& ring : rings)
      outline.push_back({static_cast<int>(ring.part), rounded(ring.radius_mm), rounded(ring.height_mm)});
    tools[std::to_string(number)] = outline;
  }
  return {{"chain", chain_json(view.machine)}, {"tools", tools}};
}

}  // namespace camber::report
