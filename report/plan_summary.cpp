#include "report/plan_summary.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "base/json.h"
#include "base/numbers.h"
#include "plan/joined_runs.h"
#include "report/figures_json.h"

namespace camber::report {

using plan::PlannedDivision;
using plan::PlanOperation;
using plan::SetupPlan;

namespace {

std::string_view word(plan::Pattern p) { return plan::kPatterns[static_cast<std::size_t>(p)]; }
std::string_view word(plan::OperationKind k) { return plan::kOperationKinds[static_cast<std::size_t>(k)]; }

Json corner(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

Json operation_json(const PlanOperation& o) {
  const plan::Conditions& c = o.conditions;
  Json j{{"primitive", o.primitive},
         {"tool", o.tool},
         {"feature", plan::to_string(o.feature)},
         {"kind", word(o.kind)},
         {"mode", word(o.pattern)},
         {"S", c.spindle_rpm},
         {"F", c.feed_mm_per_min},
         {"radial_mm", c.radial_mm},
         {"axial_mm", c.axial_mm},
         {"allowance_mm", o.allowance_mm},
         {"nominal_time_s", o.nominal_time_s},
         {"volume_mm3", o.volume_mm3},
         {"limit", c.limit},
         {"force_N", c.loads.force_N},
         {"deflection_um", 1000 * c.loads.deflection_mm},
         {"form_error_um", 1000 * c.loads.form_error_mm},
         {"power_W", c.loads.power_W}};
  if (o.joined) j["joined"] = true;
  if (o.time_s > 0) j["time_s"] = o.time_s;
  j["notes"] = o.notes;
  return j;
}

Json primitive_json(const PlannedDivision& p, std::size_t number) {
  const plan::Step& step = p.order.steps[number];
  const plan::VolumePrimitive& of = p.primitives[step.primitive];
  return {{"primitive", number + 1},      {"feature", plan::to_string(step.feature)},
          {"from_mm", corner(of.min_mm)}, {"to_mm", corner(of.max_mm)},
          {"volume_mm3", of.volume_mm3},  {"open_faces", step.open.count()},
          {"width_mm", step.width_mm}};
}

Json plan_row(const PlannedDivision& p) {
  Json j{{"division", plan::to_string(p.division)}, {"nominal_time_s", p.nominal_time_s},
         {"tool_changes", p.tool_changes},          {"form_error_p95_um", 1000 * p.form_error_p95_mm},
         {"primitives", p.primitives.size()},       {"complete", p.complete()}};
  if (p.program) {
    j["time_s"] = p.program->time_s;
    j["removed_mm3"] = p.program->removed_mm3;
    j["left_um"] = {{"p95", p.program->left_p95_um}, {"max", p.program->left_max_um}};
    j["gouge_um"] = p.program->gouge_um;
  }
  j["unmachined"] = Json::array();
  for (const plan::Unmachined& u : p.unmachined) j["unmachined"].push_back({{"what", u.what}, {"reason", u.reason}});
  return j;
}

Json setup_json(const SetupPlan& s) {
  const PlannedDivision& best = s.plans[s.best];
  Json j{{"name", s.setup.name},
         {"removal_mm3", s.removal.cells_mm3 + s.removal.holes_mm3},
         {"balance", s.removal.balance()},
         {"best", s.best}};
  j["plans"] = Json::array();
  for (const PlannedDivision& p : s.plans) j["plans"].push_back(plan_row(p));
  j["primitives"] = Json::array();
  for (std::size_t i = 0; i < best.order.steps.size(); ++i) j["primitives"].push_back(primitive_json(best, i));
  j["operations"] = Json::array();
  for (const PlanOperation& o : best.operations) j["operations"].push_back(operation_json(o));
  return j;
}

std::string size_text(const PlanOperation& o, const PlannedDivision& p) {
  const plan::VolumePrimitive& of = p.primitives[p.order.steps[o.primitive - 1].primitive];
  const Vec3 size = of.max_mm - of.min_mm;
  return fmt::format("{:.4g} x {:.4g} x {:.4g}", size.x(), size.y(), size.z());
}

std::string operations_text(const plan::PlanInput& input, const PlannedDivision& p) {
  std::string out = fmt::format("{:>2} {:<14}{:<8}{:<18}{:>7}{:>7}{:>6}{:>6}{:>8}  {}\n", "", "feature", "kind", "tool",
                                "S", "F", "RD", "AD", "s", "limit");
  for (std::size_t i = 0; i < p.operations.size(); ++i) {
    const PlanOperation& o = p.operations[i];
    const plan::PlanTool& t = input.tools.at(o.tool);
    out +=
        fmt::format("{:>2} {:<14}{:<8}{:<18}{:>7.0f}{:>7.0f}{:>6}{:>6}{:>8.1f}  {}\n", i + 1, to_string(o.feature),
                    word(o.kind), fmt::format("{} {}", to_string(t.use), format_trimmed(t.tool.diameter_mm, 2)),
                    o.conditions.spindle_rpm, o.conditions.feed_mm_per_min, format_trimmed(o.conditions.radial_mm, 2),
                    format_trimmed(o.conditions.axial_mm, 2), o.nominal_time_s,
                    o.conditions.limit + (o.joined ? fmt::format("; with {}", plan::first_of_run(p, i) + 1) : ""));
  }
  return out;
}

std::string plans_text(const SetupPlan& s) {
  const bool programs = std::ranges::any_of(s.plans, [](const PlannedDivision& p) { return p.program.has_value(); });
  std::string out = fmt::format("{:<10}{:>12}{:>12}{:>10}{}{:>14}{:>20}\n", "plan", "primitives", "operations",
                                "time, s", programs ? "  program, s" : "", "tool changes", "form error p95, um");
  for (std::size_t i = 0; i < s.plans.size(); ++i) {
    const PlannedDivision& p = s.plans[i];
    out += fmt::format("{:<10}{:>12}{:>12}{:>10.1f}{}{:>14}{:>20.1f}{}\n", plan::to_string(p.division),
                       p.primitives.size(), p.operations.size(), p.nominal_time_s,
                       !programs   ? std::string()
                       : p.program ? fmt::format("{:>12.1f}", p.program->time_s)
                                   : fmt::format("{:>12}", "-"),
                       p.tool_changes, 1000 * p.form_error_p95_mm,
                       i == s.best    ? "  taken"
                       : p.complete() ? ""
                                      : "  incomplete");
  }
  return out;
}

}  // namespace

std::string plan_json(const plan::PlanInput&, const plan::PlanResult& result, double compute_s) {
  Json j;
  j["schema_version"] = kSchemaVersion;
  j["removal_mm3"] = result.removal_mm3;
  const SetupPlan& first = result.setups.front();
  Json of_first = setup_json(first);
  j["plans"] = of_first["plans"];
  j["operations"] = Json::array();
  j["setups"] = Json::array();
  for (const SetupPlan& s : result.setups) {
    j["setups"].push_back(setup_json(s));
    for (const PlanOperation& o : s.plans[s.best].operations) j["operations"].push_back(operation_json(o));
  }
  j["compute_s"] = compute_s;
  return j.dump(2) + "\n";
}

std::string plan_text(const plan::PlanInput& input, const plan::PlanResult& result, double compute_s) {
  std::string out;
  for (const SetupPlan& s : result.setups) {
    if (result.setups.size() > 1) out += s.setup.name + "\n";
    out += fmt::format("removal volume {:.1f} mm3 in cells and {} holes, {:+.3f} % off blank minus part\n",
                       s.removal.cells_mm3 + s.removal.holes_mm3, s.removal.holes.size(), 100 * s.removal.balance());
    out += plans_text(s) + operations_text(input, s.plans[s.best]);
    for (std::size_t i = 0; i < s.plans[s.best].operations.size(); ++i)
      for (const std::string& note : s.plans[s.best].operations[i].notes)
        out += fmt::format("operation {}, {}: {}\n", i + 1, size_text(s.plans[s.best].operations[i], s.plans[s.best]),
                           note);
  }
  for (const SetupPlan& s : result.setups)
    if (const auto& program = s.plans[s.best].program)
      out += fmt::format(
          "program: {:.1f} s by the feed model, {:.1f} s by equation (3) ({:+.0f} %); left on the part {:.0f} um "
          "(p95), "
          "gouge {:.1f} um\n",
          program->time_s, s.plans[s.best].nominal_time_s, 100 * (s.plans[s.best].nominal_time_s / program->time_s - 1),
          program->left_p95_um, program->gouge_um);
  return out + fmt::format("computed in {:.1f} s\n", compute_s);
}

std::vector<std::string> plan_failures(const plan::PlanResult& result) {
  std::vector<std::string> out;
  const SetupPlan& last = result.setups.back();
  for (const plan::Unmachined& u : last.plans[last.best].unmachined)
    out.push_back(fmt::format("{} stays: {}", u.what, u.reason));
  return out;
}

namespace {

/// Median and 90th percentile of |ratio - 1| where larger than 1, 1/ratio - 1 where less: a factor either way.
std::string factors(std::vector<double> ratios) {
  for (double& r : ratios) r = std::max(r, 1 / r);
  std::ranges::sort(ratios);
  const auto at = [&](double share) {
    return ratios[static_cast<std::size_t>(share * static_cast<double>(ratios.size() - 1))];
  };
  return ratios.empty() ? std::string("      -       -") : fmt::format("{:>7.2f} {:>7.2f}", at(0.5), at(0.9));
}

}  // namespace

std::string cases_error_text(const plan::CaseBase& base) {
  std::map<std::string, std::array<std::vector<double>, 2>> by_tool;
  std::size_t dissimilar = 0;
  const auto rows = plan::leave_one_out(base);
  for (const plan::LeftOut& row : rows) {
    dissimilar += row.similar ? 0 : 1;
    for (const std::string& name : {row.of->content.tool, std::string("all")}) {
      by_tool[name][0].push_back(row.speed_ratio);
      if (row.feed_ratio) by_tool[name][1].push_back(*row.feed_ratio);
    }
  }
  std::string out =
      fmt::format("{} cases, each asked of the others: factor between predicted and true\n", base.cases.size());
  out += fmt::format("{:<16}{:>6}{:>20}{:>22}\n", "tool", "cases", "speed: median, p90", "feed: median, p90");
  for (const auto& [name, ratios] : by_tool)
    out += fmt::format("{:<16}{:>6}     {}       {}\n", name, ratios[0].size(), factors(ratios[0]), factors(ratios[1]));
  return out + fmt::format("{} of {} had no similar case; {} have no other case of their tool\n", dissimilar,
                           rows.size(), base.cases.size() - rows.size());
}

}  // namespace camber::report
