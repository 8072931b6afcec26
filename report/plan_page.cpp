// The page of camber plan: removal volume, primitives in their order, operations, the plans side by side.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/json.h"
#include "base/numbers.h"
#include "plan/joined_runs.h"
#include "report/page_tables.h"
#include "report/plan_script.h"
#include "report/plan_summary.h"

namespace camber::report {
namespace {

using plan::PlannedDivision;
using plan::SetupPlan;

constexpr std::size_t kMostTriangles = 6000;

double rounded(double v) { return std::round(1000 * v) / 1000; }

Json place_json(const Vec3& p) { return {rounded(p.x()), rounded(p.y()), rounded(p.z())}; }

/// Boxes of a primitive: itself, or of a free-form one its cells.
Json boxes_json(const plan::VolumePrimitive& p, const plan::CellGrid& grid) {
  Json out = Json::array();
  const Vec3 size = p.max_mm - p.min_mm;
  double cells = 0;
  for (const plan::CellIndex& c : p.cells) cells += grid.volume_mm3(c);
  if (p.is_hole || cells > 0.999 * size.prod())
    out.push_back({place_json(p.min_mm), place_json(p.max_mm)});
  else
    for (const plan::CellIndex& c : p.cells) out.push_back({place_json(grid.low_mm(c)), place_json(grid.high_mm(c))});
  return out;
}

Json primitives_json(const PlannedDivision& p, const plan::CellGrid& grid) {
  Json out = Json::array();
  for (const plan::Step& step : p.order.steps) {
    const plan::VolumePrimitive& of = p.primitives[step.primitive];
    const Vec3 size = of.max_mm - of.min_mm;
    out.push_back({{"name", fmt::format("{}, {:.4g} x {:.4g} x {:.4g} mm, {:.0f} mm3, {} open faces",
                                        plan::to_string(step.feature), size.x(), size.y(), size.z(), of.volume_mm3,
                                        step.open.count())},
                   {"feature", static_cast<int>(step.feature)},
                   {"hole", of.is_hole},
                   {"boxes", boxes_json(of, grid)}});
  }
  return out;
}

std::string view_data(const SetupPlan& s) {
  Json j;
  j["low"] = place_json(s.removal.blank_bounds.min_mm);
  j["high"] = place_json(s.removal.blank_bounds.max_mm);
  j["best"] = s.best;
  j["points"] = Json::array();
  j["part"] = Json::array();
  if (s.part.triangles.size() <= kMostTriangles) {
    for (const Vec3& p : s.part.points) j["points"].push_back(place_json(p));
    for (const plan::Triangle& t : s.part.triangles) j["part"].push_back({t[0], t[1], t[2]});
  }
  j["plans"] = Json::array();
  for (const PlannedDivision& p : s.plans) j["plans"].push_back({{"primitives", primitives_json(p, s.removal.grid)}});
  return script_safe(j.dump());
}

std::string view_card(const SetupPlan& s) {
  std::string choices;
  for (const PlannedDivision& p : s.plans)
    choices += fmt::format("<option>plan {}</option>", plan::to_string(p.division));
  std::string out = fmt::format(
      "<div class=\"card\"><h2>Removal volume</h2>\n<p><select id=\"plans\" aria-label=\"plan\">{}</select> "
      "<select id=\"shown\" aria-label=\"what is drawn\"><option value=\"left\">part and what is left to "
      "remove</option>"
      "<option value=\"removal\">what is removed</option><option value=\"blank\">part in the blank</option>"
      "<option value=\"part\">part</option></select> "
      "<input id=\"step\" type=\"range\" min=\"0\" max=\"1\" value=\"0\" aria-label=\"primitives machined\"> "
      "<span id=\"step-name\"></span></p>\n"
      "<canvas id=\"view\" style=\"width:100%;height:440px;touch-action:none\"></canvas>\n"
      "<noscript><p class=\"note\">The picture needs JavaScript; the tables do without.</p></noscript>\n",
      choices);
  out += "<p class=\"note\">Drag to turn, wheel to zoom; the slider machines one primitive after the other.";
  if (s.part.triangles.size() > kMostTriangles)
    out += fmt::format(" The part has {} triangles and is not drawn.", s.part.triangles.size());
  return out + "</p></div>\n";
}

TextTable plans_table(const SetupPlan& s) {
  TextTable table{"Plans",
                  {"plan", "primitives", "operations", "tools", "time by (3), s", "program, s", "tool changes",
                   "form error p95, um", ""},
                  {},
                  "Time: the sum of volume over removal rate, and the tool changes. Form error: deflection across the "
                  "wall in a steady cut, weighted by surface."};
  for (std::size_t i = 0; i < s.plans.size(); ++i) {
    const PlannedDivision& p = s.plans[i];
    std::vector<int> tools;
    for (const plan::PlanOperation& o : p.operations)
      if (std::ranges::find(tools, o.tool) == tools.end()) tools.push_back(o.tool);
    table.rows.push_back({std::string(plan::to_string(p.division)), fmt::format("{}", p.primitives.size()),
                          fmt::format("{}", p.operations.size()), fmt::format("{}", tools.size()),
                          fmt::format("{:.1f}", p.nominal_time_s),
                          p.program ? fmt::format("{:.1f}", p.program->time_s) : "-", fmt::format("{}", p.tool_changes),
                          fmt::format("{:.1f}", 1000 * p.form_error_p95_mm),
                          i == s.best    ? "taken"
                          : p.complete() ? ""
                                         : "incomplete"});
  }
  return table;
}

TextTable operations_table(const plan::PlanInput& input, const SetupPlan& s) {
  TextTable table{"Operations of the plan that is taken",
                  {"", "feature", "kind", "tool", "pattern", "S", "F", "RD", "AD", "time (4), s", "program, s", "limit",
                   "N", "um", "W", "notes"},
                  {},
                  "S rpm, F mm/min, radial and axial depth mm. N, um, W: lateral force, deflection across the wall and "
                  "power of a straight cut at these conditions. Limit: what the conditions were reduced for; cases: "
                  "nothing."};
  const PlannedDivision& p = s.plans[s.best];
  for (std::size_t i = 0; i < p.operations.size(); ++i) {
    const plan::PlanOperation& o = p.operations[i];
    const plan::PlanTool& t = input.tools.at(o.tool);
    const plan::Conditions& c = o.conditions;
    std::string notes = o.joined ? fmt::format("in one run with operation {}", plan::first_of_run(p, i) + 1) : "";
    for (const std::string& n : o.notes) notes += (notes.empty() ? "" : "; ") + n;
    table.rows.push_back(
        {fmt::format("{}", i + 1), std::string(to_string(o.feature)),
         std::string(plan::kOperationKinds[static_cast<std::size_t>(o.kind)]),
         fmt::format("T{} {} {}", o.tool, to_string(t.use), format_trimmed(t.tool.diameter_mm, 3)),
         std::string(plan::kPatterns[static_cast<std::size_t>(o.pattern)]), fmt::format("{:.0f}", c.spindle_rpm),
         fmt::format("{:.0f}", c.feed_mm_per_min), format_trimmed(c.radial_mm, 2), format_trimmed(c.axial_mm, 2),
         fmt::format("{:.1f}", o.nominal_time_s), o.time_s > 0 ? fmt::format("{:.1f}", o.time_s) : "-", c.limit,
         fmt::format("{:.0f}", c.loads.force_N), fmt::format("{:.1f}", 1000 * c.loads.form_error_mm),
         fmt::format("{:.0f}", c.loads.power_W), notes});
  }
  return table;
}

std::vector<Figure> plan_figures(const plan::PlanResult& result) {
  double time = 0, changes = 0, operations = 0;
  for (const SetupPlan& s : result.setups) {
    const PlannedDivision& p = s.plans[s.best];
    time += p.nominal_time_s;
    changes += p.tool_changes;
    operations += static_cast<double>(p.operations.size());
  }
  return {{"time by equation (3)", time, {}, "s", 1, "plans[].nominal_time_s"},
          {"operations", operations, {}, "", 0, ""},
          {"tool changes", changes, {}, "", 0, "plans[].tool_changes"},
          {"removal volume", result.removal_mm3, {}, "mm3", 0, "removal_mm3"}};
}

}  // namespace

std::string plan_page(const plan::PlanInput& input, const plan::PlanResult& result,
                      const std::vector<std::string>& warnings) {
  ReportData data;
  data.figures = plan_figures(result);
  std::string out = page_head("Plan of " + input.part_path,
                              fmt::format("{}, {}, machine {}", input.path, input.work_material, input.machine_path));
  out += tiles_html(data) + list_html("Not machined", "warnings", plan_failures(result)) +
         list_html("Warnings", "warnings", warnings) + view_card(result.setups.front());
  for (const SetupPlan& s : result.setups) {
    if (result.setups.size() > 1) out += fmt::format("<h2>{}</h2>\n", html_text(s.setup.name));
    out += table_html(plans_table(s)) + table_html(operations_table(input, s));
  }
  return out + "</main>\n" +
         fmt::format("<script type=\"application/json\" id=\"plan-data\">{}</script>\n<script>{}</script>\n",
                     view_data(result.setups.front()), kPlanScript) +
         "</body>\n</html>\n";
}

}  // namespace camber::report
