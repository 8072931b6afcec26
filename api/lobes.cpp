#include "camber/lobes.h"

#include <fmt/format.h>

#include "api/job.h"
#include "api/run.h"
#include "dynamics/tool_lobes.h"
#include "dynamics/tool_modes.h"
#include "report/lobes_summary.h"

namespace camber {
namespace {

using dynamics::LobeRequest;

const machine::Tool& lobes_tool(const machine::Job& job, const std::optional<int>& number) {
  if (!number && job.tools.size() == 1) return job.tools.begin()->second;
  const auto found = job.tools.find(number.value_or(-1));
  if (!number) fail_on_file(job.path, "has several tools; --tool N was expected", "tool-missing");
  if (found == job.tools.end()) fail_on_file(job.path, fmt::format("has no [tool.{}]", *number), "tool-missing");
  return found->second;
}

LobeRequest lobes_request(const LobesOptions& a, const machine::Job& job) {
  LobeRequest r;
  r.tool = lobes_tool(job, a.tool);
  if (a.radial_mm > r.tool.diameter_mm)
    fail_on_file("--radial-mm",
                 fmt::format("{:g}: at most the diameter of T{}, {:g}, was expected", a.radial_mm, r.tool.number,
                             r.tool.diameter_mm),
                 "value-range");
  r.modes = dynamics::modes_of(r.tool);
  r.modes.insert(r.modes.end(), job.workpiece_modes.begin(), job.workpiece_modes.end());
  r.material = job.material;
  r.chip_mm = a.chip_mm;
  r.radial_mm = a.radial_mm;
  r.milling = a.up ? dynamics::Milling::up : dynamics::Milling::down;
  r.method = a.zero_order ? dynamics::LobeMethod::zero_order : dynamics::LobeMethod::semi_discretisation;
  r.process_damping_N_per_mm = a.process_damping_N_per_mm;
  return r;
}

}  // namespace

LobesResult v0::lobes(const Job& job, const LobesOptions& options, const RunOptions& run_options) {
  LobesResult result;
  api::Run run(run_options);
  run.execute([&] {
    run.settle_first(job.impl().found);
    const LobeRequest request = lobes_request(options, job.impl().job);
    const auto found = dynamics::tool_lobes(request, options.speeds_rpm);
    result.tool = request.tool.number;
    for (const dynamics::LobePoint& p : found)
      result.lobes.push_back({p.speed_rpm, p.critical.depth_mm, p.critical.chatter_hz, std::string(name_of(p.border))});
    result.diagnostics = job.impl().found.all();
    result.csv = report::lobes_csv(found);
    result.plot = report::lobes_svg(found);
    result.json = report::lobes_json(request, found);
    result.printed = report::lobes_text(request, found);
  });
  return result;
}

}  // namespace camber
