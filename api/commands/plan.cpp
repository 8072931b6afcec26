#include "api/commands/plan.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "plan/plan_table.h"

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

bool same_conditions(const plan::Case& a, const plan::Case& b) {
  constexpr double kSame = 1e-3;
  return plan::to_toml(plan::Case{a.content}) == plan::to_toml(plan::Case{b.content}) &&
         std::abs(a.speed_m_per_min - b.speed_m_per_min) <= kSame * a.speed_m_per_min && a.feed_mm_per_min &&
         b.feed_mm_per_min && std::abs(*a.feed_mm_per_min - *b.feed_mm_per_min) <= kSame * *a.feed_mm_per_min;
}

}  // namespace

PlannedFiles plan_job(const plan::PlanInput& input, const std::string& operations, Diagnostics& diagnostics) {
  PlannedFiles out{plan::make_plan(input, diagnostics), {}};
  if (!operations.empty()) plan::read_operations(operations, input, out.result.setups.front(), diagnostics);
  out.files = files_of(input, out.result);
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
