// The page of camber plan: removal volume, primitives in their order, operations, the plans side by side.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/json.h"
#include "base/numbers.h"
#include "plan/joined_runs.h"
#include "report/page_tables.h"
#include "report/plan_summary.h"

namespace camber::report {
namespace {

// Boxes, cylinders and triangles on a canvas, sorted by depth.
constexpr std::string_view kPlanScript = R"js(
'use strict';
const data = JSON.parse(document.getElementById('plan-data').textContent);
const canvas = document.getElementById('view'), slider = document.getElementById('step'), label = document.getElementById('step-name');
const plans = document.getElementById('plans'), shown = document.getElementById('shown'), pen = canvas.getContext('2d');
let turn = -0.6, tilt = 0.9, zoom = 1;
const middle = [0, 1, 2].map(a => (data.low[a] + data.high[a]) / 2);
const size = Math.hypot(...[0, 1, 2].map(a => data.high[a] - data.low[a]));
const colours = ['#1668b8', '#2c9a5b', '#d9622b', '#8a4fbf', '#c9a227', '#b83a52', '#3aa6a6', '#6b7d2f', '#7a5a43'];

function project(p) {
  const [x, y, z] = p.map((v, a) => v - middle[a]);
  const c = Math.cos(turn), s = Math.sin(turn), u = c * x - s * y, v = s * x + c * y;
  const scale = zoom * Math.min(canvas.width, canvas.height) / size;
  return [canvas.width / 2 + scale * u, canvas.height / 2 - scale * (Math.sin(tilt) * z + Math.cos(tilt) * v),
          Math.sin(tilt) * -v + Math.cos(tilt) * z];
}

function boxFaces(a, b) {
  const c = i => [i & 1 ? b[0] : a[0], i & 2 ? b[1] : a[1], i & 4 ? b[2] : a[2]];
  return [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]].map(f => f.map(c));
}

function cylinderFaces(a, b) {
  const n = 20, x = (a[0] + b[0]) / 2, y = (a[1] + b[1]) / 2, r = (b[0] - a[0]) / 2, faces = [];
  const at = (i, z) => [x + r * Math.cos(2 * Math.PI * i / n), y + r * Math.sin(2 * Math.PI * i / n), z];
  for (let i = 0; i < n; ++i) faces.push([at(i, a[2]), at(i + 1, a[2]), at(i + 1, b[2]), at(i, b[2])]);
  for (const z of [b[2], a[2]]) faces.push(Array.from({length: n}, (_, i) => at(i, z)));
  return faces;
}

function shade(colour, points) {
  const [a, b, c] = points, u = b.map((v, i) => v - a[i]), w = c.map((v, i) => v - a[i]);
  const n = [u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]], l = Math.hypot(...n) || 1;
  const light = 0.62 + 0.38 * Math.abs((0.3 * n[0] + 0.5 * n[1] + 0.8 * n[2]) / l);
  return '#' + [1, 3, 5].map(i => Math.round(parseInt(colour.slice(i, i + 2), 16) * light).toString(16).padStart(2, '0')).join('');
}

function draw() {
  const plan = data.plans[plans.selectedIndex], step = +slider.value, what = shown.value, faces = [];
  const add = (points, colour, alpha) => {
    const flat = points.map(project);
    faces.push({flat, colour: shade(colour, points), alpha, depth: flat.reduce((s, p) => s + p[2], 0) / flat.length});
  };
  if (what !== 'removal') for (const t of data.part) add(t.map(i => data.points[i]), '#aab4c0', 1);
  if (what === 'blank') for (const f of boxFaces(data.low, data.high)) add(f, '#c7b58a', 0.25);
  plan.primitives.forEach((p, i) => {
    if (what === 'part' || (what !== 'removal' && i < step)) return;
    if (what === 'removal' && i >= step && step > 0) return;
    const colour = i === step - 1 && what === 'removal' ? '#ff2d55' : colours[p.feature];
    for (const box of p.boxes) for (const f of (p.hole ? cylinderFaces : boxFaces)(box[0], box[1])) add(f, colour, what === 'removal' ? 0.92 : 0.55);
  });
  faces.sort((a, b) => a.depth - b.depth);
  pen.clearRect(0, 0, canvas.width, canvas.height);
  for (const f of faces) {
    pen.globalAlpha = f.alpha;
    pen.beginPath();
    f.flat.forEach((p, i) => i ? pen.lineTo(p[0], p[1]) : pen.moveTo(p[0], p[1]));
    pen.closePath();
    pen.fillStyle = pen.strokeStyle = f.colour;
    pen.fill();
    pen.stroke();
  }
  pen.globalAlpha = 1;
  const p = plan.primitives[step - 1];
  label.textContent = p ? `${step}: ${p.name}` : 'nothing is machined yet';
}

function choose() {
  slider.max = data.plans[plans.selectedIndex].primitives.length;
  slider.value = Math.min(+slider.value, +slider.max);
  draw();
}

function fit() {
  canvas.width = canvas.clientWidth * devicePixelRatio;
  canvas.height = canvas.clientHeight * devicePixelRatio;
  draw();
}

let last = null;
canvas.addEventListener('pointerdown', e => { last = [e.clientX, e.clientY]; canvas.setPointerCapture(e.pointerId); });
canvas.addEventListener('pointerup', () => { last = null; });
canvas.addEventListener('pointermove', e => {
  if (!last) return;
  turn += (e.clientX - last[0]) * 0.01;
  tilt = Math.max(0.05, Math.min(1.52, tilt - (e.clientY - last[1]) * 0.01));
  last = [e.clientX, e.clientY];
  draw();
});
canvas.addEventListener('wheel', e => { e.preventDefault(); zoom *= Math.exp(-e.deltaY * 0.001); draw(); }, {passive: false});
plans.addEventListener('change', choose);
shown.addEventListener('change', draw);
slider.addEventListener('input', draw);
addEventListener('resize', fit);
plans.selectedIndex = data.best;
choose();
fit();
document.documentElement.dataset.ready = 'yes';
)js";

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
