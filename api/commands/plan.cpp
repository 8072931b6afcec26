#include "api/commands/plan.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "plan/plan_table.h"
#include "plan/programs.h"

namespace camber::api {
namespace {

/// "" for the only set-up, "-2" for the second one.
std::string suffix(const plan::PlanResult& result, std::size_t setup) {
  return result.setups.size() > 1 ? fmt::format("-{}", setup + 1) : std::string();
}

std::vector<std::pair<std::string, std::string>> files_of(const plan::PlanInput& input,
                                                          const plan::PlanResult& result) {
  std::vector<std::pair<std::string, std::string>> out;
  for (std::size_t i = 0; i < result.setups.size(); ++i) {
    const plan::SetupPlan& s = result.setups[i];
    const std::string end = suffix(result, i);
    out.emplace_back(fmt::format("operations{}.toml", end), plan::operations_toml(input, s, s.best));
    for (std::size_t p = 0; p < s.plans.size() && s.plans.size() > 1; ++p)
      out.emplace_back(fmt::format("plan-{}{}.toml", plan::to_string(s.plans[p].division), end),
                       plan::operations_toml(input, s, p));
  }
  return out;
}

std::string absolute(const std::string& path) {
  return path.empty() ? path : std::filesystem::absolute(path).lexically_normal().string();
}

/// True where blank and part lie on the machine as in their files.
bool lies_as_given(const plan::PlanInput& input, const plan::SetupPlan& setup) {
  return setup.setup.turn.isIdentity() && input.mm_per_unit == 1;
}

/// The job of camber copy; solids that are turned or scaled are files beside it.
void add_copy_job(const plan::PlanInput& input, const plan::SetupPlan& setup, const std::string& end,
                  std::vector<std::pair<std::string, std::string>>& files) {
  const bool as_given = lies_as_given(input, setup);
  const std::string part = fmt::format("part{}.stl", end), blank = fmt::format("blank{}.stl", end);
  if (!as_given) {
    files.emplace_back(part, plan::stl_text(setup.part));
    files.emplace_back(blank, plan::stl_text(setup.blank));
  }
  machine::Job job = plan::copy_job(input, as_given ? absolute(input.part_path) : part, as_given ? "" : blank);
  job.machine_path = absolute(job.machine_path);
  job.program = fmt::format("program{}.nc", end);
  if (as_given) job.stock.mesh = absolute(job.stock.mesh), job.stock.vdb = absolute(job.stock.vdb);
  files.emplace_back(fmt::format("job{}.toml", end),
                     plan::copy_job_toml(job, plan::copy_operations(input, setup.plans[setup.best])));
}

/// program.nc, and one an operation, of a plan that is taken; its times go to the plan.
void add_programs(const plan::PlanInput& input, plan::SetupPlan& setup, const std::string& end,
                  Diagnostics& diagnostics, std::vector<std::pair<std::string, std::string>>& files) {
  if (!lies_as_given(input, setup)) {
    diagnostics.add({Severity::warning,
                     {input.path, 0, 0},
                     fmt::format("{} is turned or in inches: its programs are made by camber copy from job{}.toml",
                                 setup.setup.name, end),
                     "plan-programs",
                     {}});
    return;
  }
  plan::PlannedDivision& plan = setup.plans[setup.best];
  const plan::PlanProgram made = plan::make_program(input, plan::copy_job(input, input.part_path, ""),
                                                    plan::copy_operations(input, plan), diagnostics);
  plan.program = made.figures;
  for (std::size_t i = 0; i < plan.operations.size(); ++i) {
    plan.operations[i].time_s = made.times_s[i];
    if (!made.each[i].empty()) files.emplace_back(fmt::format("operation{}-{:02}.nc", end, i + 1), made.each[i]);
  }
  files.emplace_back(fmt::format("program{}.nc", end), made.whole);
}

bool same_conditions(const plan::Case& a, const plan::Case& b) {
  constexpr double kSame = 1e-3;
  return plan::to_toml(plan::Case{a.content}) == plan::to_toml(plan::Case{b.content}) &&
         std::abs(a.speed_m_per_min - b.speed_m_per_min) <= kSame * a.speed_m_per_min && a.feed_mm_per_min &&
         b.feed_mm_per_min && std::abs(*a.feed_mm_per_min - *b.feed_mm_per_min) <= kSame * *a.feed_mm_per_min;
}

}  // namespace

PlannedFiles plan_job(const plan::PlanInput& input, const PlanJobOptions& options, Diagnostics& diagnostics) {
  PlannedFiles out{plan::make_plan(input, diagnostics), {}};
  if (!options.operations.empty())
    plan::read_operations(options.operations, input, out.result.setups.front(), diagnostics);
  out.files = files_of(input, out.result);
  for (std::size_t i = 0; i < out.result.setups.size(); ++i) {
    add_copy_job(input, out.result.setups[i], suffix(out.result, i), out.files);
    if (options.programs) add_programs(input, out.result.setups[i], suffix(out.result, i), diagnostics, out.files);
  }
  return out;
}

LearnedCases learn_cases(const plan::PlanInput& input, const plan::PlanResult& result) {
  LearnedCases out{SourceText::read(input.cases.path).text()};
  std::vector<plan::Case> known = input.cases.cases;
  for (const plan::SetupPlan& s : result.setups)
    for (const plan::Operation& o : s.plans[s.best].operations) {
      const plan::PlanTool& t = input.tools.at(o.tool);
      plan::Case c{.content = {input.work_material, std::string(to_string(t.use)), t.material, t.coated,
                               o.kind == plan::OperationKind::finish && input.fine, input.fast, t.tool.diameter_mm},
                   .speed_m_per_min = kPi * t.tool.diameter_mm * o.conditions.spindle_rpm / 1000,
                   .feed_mm_per_min = o.conditions.feed_mm_per_min};
      if (o.pattern != plan::Pattern::drilling) {
        c.axial_depth_mm = o.conditions.axial_mm;
        c.radial_depth_mm = o.conditions.radial_mm;
      }
      if (std::ranges::any_of(known, [&](const plan::Case& k) { return same_conditions(k, c); })) continue;
      known.push_back(c);
      out.text += (out.text.ends_with('\n') ? "" : "\n") + plan::to_toml(c);
      ++out.added;
    }
  return out;
}

}  // namespace camber::api
