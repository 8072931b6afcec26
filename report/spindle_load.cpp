#include "report/forces_csv.h"

#include <algorithm>
#include <map>

#include "base/numbers.h"
#include "base/output_file.h"

namespace camber::report {

std::vector<SpindleLoad> spindle_loads(const machine::Job& job, const simulate::SimulatedProgram& program,
                                       const simulate::Prediction& prediction) {
  std::vector<int> order;
  std::map<std::pair<std::size_t, std::size_t>, SpindleLoad> loads;  // by the tool's place in the order and the line
  for_each_force_row(job, program, prediction, [&](const ForceRow& row) {
    if (row.removed_mm3 <= 0) return;
    auto place = std::ranges::find(order, row.tool);
    if (place == order.end()) place = order.insert(order.end(), row.tool);
    SpindleLoad& load = loads[{static_cast<std::size_t>(place - order.begin()), row.line}];
    load.tool = row.tool;
    load.line = row.line;
    load.power_W = std::max(load.power_W, row.power_W);
    load.torque_Nm = std::max(load.torque_Nm, row.torque_mean_Nm);
  });
  std::vector<SpindleLoad> out;
  for (const auto& [key, load] : loads) out.push_back(load);
  return out;
}

void write_spindle_load_csv(const std::string& path, const std::vector<SpindleLoad>& loads) {
  std::string text = "tool,line,power_W,torque_Nm\n";
  for (const SpindleLoad& load : loads) {
    append_cells(text, 0, {static_cast<double>(load.tool), static_cast<double>(load.line)});
    append_cells(text, 4, {load.power_W});
    append_cells(text, 6, {load.torque_Nm});
    text.back() = '\n';
  }
  write_file(path, text);
}

}  // namespace camber::report
