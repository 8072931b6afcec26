#include "plan/programs.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/numbers.h"
#include "machine/number_key.h"
#include "machine/toml_table.h"
#include "plan/joined_runs.h"

namespace camber::plan {
namespace {

using machine::kNotNegative;
using machine::kPositive;
using machine::TomlTable;

std::string number(double v, int decimals = 4) { return format_trimmed(v, decimals); }

std::string point(const Vec2& p) { return fmt::format("[{}, {}]", number(p.x()), number(p.y())); }

std::string row_toml(const PlannedDivision& plan, std::size_t index, const PlanTool& tool) {
  const PlanOperation& o = plan.operations[index];
  const Conditions& c = o.conditions;
  std::string out = fmt::format("\n[[operation]]  # {}: {}, {} of {} mm\n", index + 1, to_string(o.feature),
                                to_string(tool.use), number(tool.tool.diameter_mm));
  out += fmt::format("primitive = {}\nkind = \"{}\"\ntool = {}\nmode = \"{}\"\n", o.primitive,
                     kOperationKinds[static_cast<std::size_t>(o.kind)], o.tool,
                     kPatterns[static_cast<std::size_t>(o.pattern)]);
  out += fmt::format("spindle_rpm = {}\nfeed_mm_per_min = {}\n", number(c.spindle_rpm), number(c.feed_mm_per_min));
  if (o.pattern != Pattern::drilling) out += fmt::format("radial_depth_mm = {}\n", number(c.radial_mm));
  out += fmt::format("axial_depth_mm = {}\n", number(c.axial_mm));
  if (o.joined) out += fmt::format("joined = true  # cut in one run with {}\n", first_of_run(plan, index) + 1);
  if (o.allowance_mm > 0) out += fmt::format("allowance_mm = {}\n", number(o.allowance_mm));
  if (o.scallop_mm > 0) out += fmt::format("scallop_mm = {}\n", number(o.scallop_mm));
  out += fmt::format("box_mm = [{}, {}]\nz_mm = [{}, {}]\n", point(o.box_mm[0]), point(o.box_mm[1]), number(o.from_mm),
                     number(o.to_mm));
  out += fmt::format("# removes {:.1f} mm3 in {:.1f} s by equation (4); limit: {}; {:.0f} N, {:.1f} um, {:.0f} W\n",
                     o.volume_mm3, o.nominal_time_s, c.limit, c.loads.force_N, 1000 * c.loads.form_error_mm,
                     c.loads.power_W);
  for (const std::string& note : o.notes) out += "# " + note + "\n";
  return out;
}

constexpr std::array<std::string_view, 3> kDivisionWords{"yz", "zx", "largest"};

/// The operation that planning makes for the row's primitive and kind, else its primitive's first one.
const PlanOperation* planned(const PlannedDivision& plan, std::size_t primitive, OperationKind kind) {
  const PlanOperation* first = nullptr;
  for (const PlanOperation& o : plan.operations) {
    if (o.primitive != primitive) continue;
    if (o.kind == kind) return &o;
    if (first == nullptr) first = &o;
  }
  return first;
}

/// Takes the row's conditions where they are given; the rest by cases where the tool is another one.
void read_conditions(TomlTable& row, const PlanInput& input, const PlanTool& tool, bool same_tool, PlanOperation& op) {
  if (!same_tool) {
    std::string note;
    const CutNeed cut{op.kind == OperationKind::finish, op.to_mm - op.from_mm, machine::kNoLimit};
    const auto found = conditions_for(input, tool, cut, note);
    if (found)
      op.conditions = *found;
    else
      row.error_at("tool", note, "no-case");
  }
  Conditions& c = op.conditions;
  bool given = false;
  const auto take = [&](std::string_view key, double& into) {
    const auto v = row.optional_number(key, kPositive);
    constexpr double kSame = 1e-4;  // the table's decimals
    given = given || (v && std::abs(*v - into) > kSame);
    if (v) into = *v;
  };
  take("spindle_rpm", c.spindle_rpm);
  take("feed_mm_per_min", c.feed_mm_per_min);
  take("radial_depth_mm", c.radial_mm);
  take("axial_depth_mm", c.axial_mm);
  if (!given) return;
  const bool drills = op.pattern == Pattern::drilling;
  c.loads = drills ? drill_loads(tool.tool, input.material, c) : mill_loads(tool.tool, input.material, c);
  const Conditions least = bounded(c, input, tool);
  c.limit = "given";
  if (least.limit != "given" && least.limit != "cases" &&
      (least.feed_mm_per_min < c.feed_mm_per_min * 0.999 || least.axial_mm < c.axial_mm * 0.999))
    row.warning_at(
        "feed_mm_per_min",
        fmt::format("the conditions are beyond the limit \"{}\", which asks for {:.0f} mm/min and {:.3g} mm deep",
                    least.limit, least.feed_mm_per_min, least.axial_mm),
        "plan-limit");
}

/// Whether it is cut in one run with the row before.
void read_joined(TomlTable& row, const std::vector<PlanOperation>& before, PlanOperation& op) {
  op.joined = row.boolean("joined", false);
  if (!op.joined) return;
  constexpr std::string_view kExpected = "; an operation that is cut in one run with the row before was expected";
  if (before.empty()) {
    row.error_at("joined", fmt::format("joined = true in the first row{}", kExpected), "plan-joined");
    return;
  }
  if (const std::string why = not_joined_because(before.back(), op); !why.empty())
    row.error_at("joined", fmt::format("joined = true, but {}{}", why, kExpected), "plan-joined");
  const Conditions &c = op.conditions, &with = before.back().conditions;
  constexpr double kSame = 1e-4;  // the table's decimals
  if (std::abs(c.spindle_rpm - with.spindle_rpm) > kSame ||
      std::abs(c.feed_mm_per_min - with.feed_mm_per_min) > kSame || std::abs(c.radial_mm - with.radial_mm) > kSame ||
      std::abs(c.axial_mm - with.axial_mm) > kSame)
    row.error_at("joined",
                 "joined = true, but spindle speed, feed or depths are not those of the row before; the same were "
                 "expected in one run",
                 "plan-joined");
}

std::optional<PlanOperation> read_row(TomlTable& row, const PlanInput& input, const PlannedDivision& plan,
                                      const std::vector<PlanOperation>& before) {
  const double last = static_cast<double>(plan.order.steps.size());
  const auto primitive =
      static_cast<std::size_t>(row.required_number("primitive", {.min = 1, .max = last, .whole = true}));
  const auto kind = row.required_choice("kind", kOperationKinds);
  if (primitive < 1 || !kind) return std::nullopt;
  const PlanOperation* base = planned(plan, primitive, static_cast<OperationKind>(*kind));
  if (base == nullptr) {
    row.error_at("primitive", fmt::format("no tool machines primitive {}; one that is planned was expected", primitive),
                 "no-operation");
    return std::nullopt;
  }
  PlanOperation op = *base;
  op.kind = static_cast<OperationKind>(*kind);
  const auto tool = row.optional_number("tool", {.min = 1, .max = 99999999, .whole = true});
  if (tool) op.tool = static_cast<int>(*tool);
  if (!input.tools.contains(op.tool)) {
    row.error_at("tool", fmt::format("tool = {0}, but there is no [tool.{0}] in {1}", op.tool, input.path),
                 "tool-missing");
    return std::nullopt;
  }
  op.pattern = static_cast<Pattern>(row.choice("mode", kPatterns, static_cast<std::size_t>(op.pattern)));
  op.allowance_mm = row.number("allowance_mm", kNotNegative, row.has("feed_mm_per_min") ? 0 : op.allowance_mm);
  op.scallop_mm = row.number("scallop_mm", kNotNegative, row.has("feed_mm_per_min") ? 0 : op.scallop_mm);
  if (const auto box = row.number_rows("box_mm", 2, 2, machine::kAnyNumber, "[[x, y], [x, y]], two opposite corners,"))
    op.box_mm = {Vec2((*box)[0][0], (*box)[0][1]), Vec2((*box)[1][0], (*box)[1][1])};
  if (const auto z = row.numbers("z_mm", 2, machine::kAnyNumber, "[lowest, highest], levels of the tip,")) {
    op.from_mm = (*z)[0], op.to_mm = (*z)[1];
    if (op.from_mm >= op.to_mm)
      row.error_at("z_mm", fmt::format("z_mm goes from {:g} to {:g}; [lowest, highest] was expected", (*z)[0], (*z)[1]),
                   "value-range");
  }
  const PlanTool& with = input.tools.at(op.tool);
  read_conditions(row, input, with, op.tool == base->tool && op.kind == base->kind, op);
  read_joined(row, before, op);
  row.finish();
  op.nominal_time_s = op.tool == base->tool && op.conditions.feed_mm_per_min == base->conditions.feed_mm_per_min &&
                              op.conditions.axial_mm == base->conditions.axial_mm &&
                              op.conditions.radial_mm == base->conditions.radial_mm
                          ? base->nominal_time_s
                          : op.volume_mm3 / removal_rate_mm3_per_s(with, op.conditions);
  return op;
}

}  // namespace

std::string operations_toml(const PlanInput& input, const SetupPlan& setup, std::size_t plan) {
  const PlannedDivision& p = setup.plans[plan];
  std::string out = fmt::format(
      "# Operations of {}, {}: edit them and run `camber plan PLAN.toml --operations THIS -o DIR`.\n"
      "# A row names its primitive and kind; every other key may be left out and is decided anew.\n"
      "# A row with joined = true is cut in one run with the row before it.\n"
      "# {:.1f} s by equation (3), {} tool changes.\n",
      input.path, setup.setup.name, p.nominal_time_s, p.tool_changes);
  out += fmt::format("division = \"{}\"\n", to_string(p.division));
  for (std::size_t i = 0; i < p.operations.size(); ++i) out += row_toml(p, i, input.tools.at(p.operations[i].tool));
  return out;
}

void read_operations(const std::string& path, const PlanInput& input, SetupPlan& setup, Diagnostics& diagnostics) {
  const auto file = machine::read_toml(path, "a table of operations (division, [[operation]])", diagnostics);
  diagnostics.throw_if_errors();
  TomlTable top = TomlTable::top(*file, diagnostics);
  const auto division = top.required_choice("division", kDivisionWords);
  if (!top.has("operation")) top.missing("[[operation]]", "a table for each operation");
  if (division) {
    PlannedDivision plan = setup.plans[*division];
    std::vector<PlanOperation> rows;
    for (TomlTable& row : top.tables("operation"))
      if (auto op = read_row(row, input, plan, rows)) rows.push_back(std::move(*op));
    plan.operations = std::move(rows);
    plan.tool_changes = tool_changes(plan.operations);
    plan.nominal_time_s = total_time_s(plan.operations, input.tool_change_s);
    plan.form_error_p95_mm = form_error_p95_mm(plan.operations);
    setup.plans = {std::move(plan)};
    setup.best = 0;
  }
  top.finish();
  diagnostics.throw_if_errors();
}

std::string stl_text(const TriangleSolid& solid) {
  TriangleMesh mesh{{}, solid.triangles};
  for (const Vec3& p : solid.points) mesh.points.push_back(p.cast<float>());
  return camber::stl_text(mesh);
}

}  // namespace camber::plan
