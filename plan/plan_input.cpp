// PLAN.toml into a PlanInput.
#include <charconv>
#include <filesystem>

#include <fmt/format.h>

#include "machine/job_tables.h"
#include "machine/machine_presets.h"
#include "machine/material_reader.h"
#include "machine/number_key.h"
#include "plan/case_base.h"
#include "plan/plan_input.h"

namespace camber::plan {
namespace {

namespace fs = std::filesystem;
using machine::kAnyNumber;
using machine::kNotNegative;
using machine::kPositive;
using machine::TomlTable;

std::string checked_path(TomlTable& table, std::string_view key, const std::string& given, const fs::path& folder) {
  const std::string path = (folder / given).lexically_normal().string();
  std::error_code ec;
  if (!fs::is_regular_file(path, ec))
    table.error_at(key, fmt::format("{}: no such file: {} (paths are relative to the plan's folder)", key, path),
                   "file-missing");
  return path;
}

std::string required_path(TomlTable& table, std::string_view key, const fs::path& folder) {
  const std::string given = table.required_text(key);
  return given.empty() ? std::string() : checked_path(table, key, given, folder);
}

/// "end mill" where the type of a cutter leaves a choice.
ToolUse usual_use(std::string_view type) {
  if (type == "ball" || type == "tapered_ball") return ToolUse::ball_end_mill;
  if (type == "drill") return ToolUse::drill;
  return type == "chamfer" ? ToolUse::center_drill : ToolUse::end_mill;
}

void check_use(TomlTable& table, const PlanTool& tool) {
  using machine::ToolType;
  const ToolType type = tool.tool.type;
  bool fits = true;
  switch (tool.use) {
    case ToolUse::end_mill:
    case ToolUse::face_mill:
      fits = type == ToolType::flat || type == ToolType::bull || type == ToolType::general;
      break;
    case ToolUse::ball_end_mill:
      fits = type == ToolType::ball || type == ToolType::tapered_ball;
      break;
    case ToolUse::center_drill:
      fits = type == ToolType::drill || type == ToolType::chamfer;
      break;
    case ToolUse::drill:
    case ToolUse::reamer:
      fits = type == ToolType::drill || type == ToolType::flat;
      break;
  }
  if (!fits)
    table.error_at(table.has("use") ? "use" : "type",
                   fmt::format("a tool of this type is no {}; \"flat\" for end mills and face mills, \"ball\" for ball "
                               "end mills, \"drill\" for drills was expected",
                               to_string(tool.use)),
                   "tool-use");
}

void read_plan_tools(TomlTable table, PlanTools& tools) {
  for (const std::string& key : table.keys()) {
    int number = 0;
    const auto [end, ec] = std::from_chars(key.data(), key.data() + key.size(), number);
    auto tool = table.table(key);
    if (ec != std::errc{} || end != key.data() + key.size() || number < 1)
      table.error_at_name(key, fmt::format("[tool.{}]: a tool number was expected, as in [tool.1] for T1", key),
                          "tool-number");
    if (!tool) continue;
    PlanTool out;
    const std::string type = tool->kind_of("type") == machine::TomlNode::Kind::text ? tool->text("type", "") : "";
    out.use = static_cast<ToolUse>(tool->choice("use", kToolUses, static_cast<std::size_t>(usual_use(type))));
    out.material = tool->text("material", out.material);
    out.coated = tool->boolean("coated", false);
    out.tool = machine::read_tool(*tool, number);
    check_use(*tool, out);
    tools.emplace(number, std::move(out));
  }
}

void read_limits(TomlTable table, PlanLimits& limits) {
  limits.force_N = table.optional_number("force_N", kPositive);
  if (const auto v = table.optional_number("deflection_um", kPositive)) limits.deflection_mm = mm_from_um(*v);
  if (const auto v = table.optional_number("form_error_um", kPositive)) limits.form_error_mm = mm_from_um(*v);
  limits.power_W = table.optional_number("power_W", kPositive);
  table.finish();
}

void read_work(TomlTable table, PlanInput& plan) {
  plan.work_material = table.required_text("material");
  plan.fine = table.choice("finish", kFinishWords, 0) == 1;
  plan.fast = table.choice("machining", kMachiningWords, 0) == 1;
  plan.allowance_mm = table.number("allowance_mm", kPositive, plan.allowance_mm);
  plan.scallop_mm = table.number("scallop_mm", kPositive, plan.scallop_mm);
  plan.coolant = table.boolean("coolant", false);
  plan.compensate = table.boolean("compensate", false);
  table.finish();
}

/// turn = [[1, 0, 0, 90], ...]: about an axis by so many degrees, one after the other.
PartSetup read_setup(TomlTable table, std::size_t number) {
  PartSetup out;
  out.name = table.text("name", fmt::format("set-up {}", number));
  constexpr std::string_view kWanted = "turns [x, y, z, degrees] about an axis, as in [[1, 0, 0, 180]],";
  const auto rows = table.number_rows("turn", 0, 4, kAnyNumber, kWanted);
  for (const auto& row : rows.value_or(std::vector<std::vector<double>>{})) {
    const Vec3 axis(row[0], row[1], row[2]);
    if (!(axis.norm() > 0)) {
      table.error_at("turn", "turn has an axis of no length; " + std::string(kWanted) + " were expected",
                     "value-range");
      continue;
    }
    out.turn = Eigen::AngleAxisd(rad_from_deg(row[3]), axis.normalized()).toRotationMatrix() * out.turn;
  }
  table.finish();
  return out;
}

void scale_blank(machine::StockDescription& blank, double by) {
  if (blank.box) blank.box->min_mm *= by, blank.box->max_mm *= by;
  if (blank.cylinder) blank.cylinder->base_mm *= by, blank.cylinder->diameter_mm *= by, blank.cylinder->height_mm *= by;
}

void read_shapes(TomlTable& top, const fs::path& folder, PlanInput& plan) {
  constexpr std::array<std::string_view, 2> kUnits{"mm", "inch"};
  plan.mm_per_unit = top.choice("units", kUnits, 0) == 1 ? 25.4 : 1;
  plan.part_path = required_path(top, "part", folder);
  if (auto blank = top.table("blank")) {
    machine::read_stock(*blank, folder, plan.blank);
    if (plan.blank.allowance_mm > 0)
      blank->error_at("allowance_mm", "allowance_mm belongs to [stock] of a job; here it is in [work]", "key-unused");
    scale_blank(plan.blank, plan.mm_per_unit);
  } else if (!top.has("blank")) {
    top.missing("[blank]", "a table with box_mm, cylinder, mesh or vdb");
  }
  for (const std::string& f : top.text_list("fixtures", "a list of STL files").value_or(std::vector<std::string>{}))
    plan.fixture_paths.push_back(checked_path(top, "fixtures", f, folder));
}

void read_tables(TomlTable& top, const fs::path& folder, PlanInput& plan, Diagnostics& diagnostics) {
  if (auto tools = top.table("tool")) read_plan_tools(*tools, plan.tools);
  if (plan.tools.empty() && !top.has("tool")) top.missing("[tool.1]", "a table for each tool of the machine");
  if (auto material = top.table("material"))
    plan.material = machine::read_material_table(*material, folder.string(), diagnostics);
  else if (!top.has("material"))
    top.missing("[material]", "a table with the specific cutting forces, as in preset = \"FC250\",");
  if (auto work = top.table("work"))
    read_work(*work, plan);
  else if (!top.has("work"))
    top.missing("[work]", "a table with the work material, as the case base names it,");
  if (auto limits = top.table("limits")) read_limits(*limits, plan.limits);
  if (auto simulation = top.table("simulation")) {
    plan.simulation.voxel_mm = simulation->number("voxel_mm", kPositive, 0.25);
    simulation->finish();
  } else {
    plan.simulation.voxel_mm = 0.25;
  }
  if (auto faces = top.table("faces")) {
    plan.faces.plane_tolerance_mm = faces->number("plane_tolerance_mm", kPositive, plan.faces.plane_tolerance_mm);
    plan.faces.circle_tolerance_mm = faces->number("circle_tolerance_mm", kPositive, plan.faces.circle_tolerance_mm);
    plan.faces.min_face_mm2 = faces->number("min_face_mm2", kNotNegative, plan.faces.min_face_mm2);
    faces->finish();
  }
  for (TomlTable& setup : top.tables("setup")) plan.setups.push_back(read_setup(setup, plan.setups.size() + 1));
  if (plan.setups.empty()) plan.setups.push_back({"set-up 1"});
}

/// Tool change time of the machine, else 10 s.
double tool_change_s(TomlTable& top, const machine::Machine& machine) {
  if (const auto given = top.optional_number("tool_change_s", kNotNegative)) return *given;
  const machine::ToolChange& change = machine.tool_change;
  const double told =
      change.chip_to_chip_s > 0 ? change.chip_to_chip_s : change.tool_to_tool_s + machine.spindle.orient_s;
  constexpr double kUsual_s = 10;
  return told > 0 ? told : kUsual_s;
}

}  // namespace

bool is_stock_file(const std::string& path) { return path.ends_with(".vdb"); }

PlanInput read_plan_input(const std::string& path, Diagnostics& diagnostics) {
  const auto file = machine::read_toml(path, "a plan (part, machine, case_base, [blank], [tool.1] ...)", diagnostics);
  diagnostics.throw_if_errors();
  const fs::path folder = fs::path(path).parent_path();
  TomlTable top = TomlTable::top(*file, diagnostics);
  PlanInput plan;
  plan.path = path;
  read_shapes(top, folder, plan);
  plan.machine_path = machine::machine_path_at(top, folder);
  const std::string cases = required_path(top, "case_base", folder);
  read_tables(top, folder, plan, diagnostics);
  std::error_code ec;
  if (machine::find_machine_preset(plan.machine_path) || fs::is_regular_file(plan.machine_path, ec))
    plan.machine = machine::read_machine(plan.machine_path, diagnostics);
  if (fs::is_regular_file(cases, ec)) plan.cases = read_case_base(cases, diagnostics);
  plan.tool_change_s = tool_change_s(top, plan.machine);
  top.finish();
  diagnostics.throw_if_errors();
  return plan;
}

}  // namespace camber::plan
