// The namespace plan comes before the function of that name: clang takes it in no other order.
#include "api/commands/plan.h"

#include "camber/plan.h"

#include <chrono>

#include "api/run.h"
#include "report/plan_summary.h"

namespace camber {
namespace {

PlannedOperation operation_of(const plan::PlanOperation& o, std::size_t setup) {
  const plan::Conditions& c = o.conditions;
  return {.setup = setup,
          .primitive = o.primitive,
          .feature = std::string(plan::to_string(o.feature)),
          .kind = std::string(plan::kOperationKinds[static_cast<std::size_t>(o.kind)]),
          .tool = o.tool,
          .mode = std::string(plan::kPatterns[static_cast<std::size_t>(o.pattern)]),
          .joined = o.joined,
          .spindle_rpm = c.spindle_rpm,
          .feed_mm_per_min = c.feed_mm_per_min,
          .radial_mm = c.radial_mm,
          .axial_mm = c.axial_mm,
          .nominal_time_s = o.nominal_time_s,
          .time_s = o.time_s,
          .limit = c.limit,
          .force_N = c.loads.force_N,
          .form_error_um = 1000 * c.loads.form_error_mm,
          .power_W = c.loads.power_W,
          .notes = o.notes};
}

PlanResult result_of(const plan::PlanResult& planned) {
  PlanResult out;
  out.unmachined = report::plan_failures(planned);
  out.success = out.unmachined.empty();
  out.removal_mm3 = planned.removal_mm3;
  const plan::SetupPlan& first = planned.setups.front();
  for (std::size_t i = 0; i < first.plans.size(); ++i) {
    const plan::PlannedDivision& p = first.plans[i];
    out.alternatives.push_back({std::string(plan::to_string(p.division)), p.nominal_time_s,
                                p.program ? p.program->time_s : 0, p.tool_changes, 1000 * p.form_error_p95_mm,
                                p.complete(), i == first.best});
  }
  for (std::size_t s = 0; s < planned.setups.size(); ++s)
    for (const plan::PlanOperation& o : planned.setups[s].plans[planned.setups[s].best].operations)
      out.operations.push_back(operation_of(o, s));
  return out;
}

}  // namespace

PlanResult v0::plan(const std::string& path, const PlanOptions& options, const RunOptions& run_options) {
  const auto begin = std::chrono::steady_clock::now();
  PlanResult result;
  api::Run run(run_options);
  run.execute([&] {
    Diagnostics found;
    const plan::PlanInput input = plan::read_plan_input(path, found);
    const api::PlannedFiles done = api::plan_job(
        input, {.operations = options.operations, .programs = options.programs, .all_programs = options.all_programs},
        found);
    run.settle(found);
    const double compute_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    result = result_of(done.result);
    result.files = done.files;
    result.diagnostics = found.all();
    result.json = report::plan_json(input, done.result, compute_s);
  });
  return result;
}

}  // namespace camber
