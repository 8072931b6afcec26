// A Job as job.toml, with every default filled in.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "machine/assumptions.h"
#include "machine/job_keys.h"
#include "machine/job_tables.h"
#include "machine/material_reader.h"

namespace camber::machine {
namespace {

using AssumedKeys = std::map<std::string, std::vector<std::string>>;

std::string assumed_line(const AssumedKeys& assumed, const std::string& table) {
  const auto at = assumed.find(table);
  return at == assumed.end() ? std::string() : fmt::format("assumed = [\"{}\"]\n", fmt::join(at->second, "\", \""));
}

std::string tool_text(const Tool& tool, const AssumedKeys& assumed) {
  std::string out = fmt::format("\n[tool.{}]\n", tool.number);
  out += toml_line("type", kToolTypeWords[static_cast<std::size_t>(tool.type)]);
  out += toml_line("flutes", tool.flutes, kAsIs) + toml_lines<Tool>(kToolKeys, tool);
  const std::string_view type = kToolTypeWords[static_cast<std::size_t>(tool.type)];
  for (const auto& k : kProfileKeys)
    if (k.belongs_to(type)) out += toml_line(k.number.key, tool.*k.number.field, k.number.unit);
  if (!tool.pitch_rad.empty()) {
    std::string degrees;
    for (const double p : tool.pitch_rad) degrees += (degrees.empty() ? "" : ", ") + toml_number(p, kDegrees);
    out += fmt::format("pitch_deg = [{}]\n", degrees);
  }
  if (tool.flute_length_mm) out += toml_line("flute_length_mm", *tool.flute_length_mm, kAsIs);
  if (tool.shank_diameter_mm > 0) out += toml_line("shank_diameter_mm", tool.shank_diameter_mm, kAsIs);
  if (tool.neck_length_mm > 0)
    out += toml_line("neck_diameter_mm", tool.neck_diameter_mm, kAsIs) +
           toml_line("neck_length_mm", tool.neck_length_mm, kAsIs);
  if (!tool.holder.empty()) {
    std::string rows;
    for (const auto& h : tool.holder)
      rows += fmt::format("{}[{}, {}, {}]", rows.empty() ? "" : ", ", toml_number(h.lower_diameter_mm, kAsIs),
                          toml_number(h.upper_diameter_mm, kAsIs), toml_number(h.length_mm, kAsIs));
    out += fmt::format("holder_mm = [{}]\n", rows);
  }
  if (tool.axial_stiffness_N_per_mm)
    out += toml_line("axial_stiffness_N_per_um", *tool.axial_stiffness_N_per_mm, kNewtonsPerMicrometre);
  if (tool.density_kg_per_m3) out += toml_line("density_kg_per_m3", *tool.density_kg_per_m3, kAsIs);
  if (tool.shear) out += "shear = true\n";
  out += assumed_line(assumed, fmt::format("tool.{}", tool.number));
  return out + modes_text(tool.modes, fmt::format("tool.{}", tool.number));
}

std::string point_text(const Vec3& p) {
  return fmt::format("[{}, {}, {}]", toml_number(p.x(), kAsIs), toml_number(p.y(), kAsIs), toml_number(p.z(), kAsIs));
}

std::string stock_text(const StockDescription& stock, const AssumedKeys& assumed) {
  std::string out = "\n[stock]\n";
  if (stock.box)
    out += fmt::format("box_mm = [{}, {}]\n", point_text(stock.box->min_mm), point_text(stock.box->max_mm));
  if (stock.cylinder)
    out += fmt::format("cylinder = {{ base_mm = {}, diameter_mm = {}, height_mm = {} }}\n",
                       point_text(stock.cylinder->base_mm), toml_number(stock.cylinder->diameter_mm, kAsIs),
                       toml_number(stock.cylinder->height_mm, kAsIs));
  if (!stock.mesh.empty()) out += toml_line("mesh", stock.mesh);
  if (!stock.vdb.empty()) out += toml_line("vdb", stock.vdb);
  return out + toml_line("allowance_mm", stock.allowance_mm, kAsIs) + assumed_line(assumed, "stock");
}

std::string operations_text(const std::string& name, const Operations& operations) {
  std::string out = fmt::format("\n[{}]\n", name);
  if (!operations.tools.empty()) out += fmt::format("tools = [{}]\n", fmt::join(operations.tools, ", "));
  std::string rows;
  for (const auto& b : operations.blocks) rows += fmt::format("{}[{}, {}]", rows.empty() ? "" : ", ", b[0], b[1]);
  if (!rows.empty()) out += fmt::format("blocks = [{}]\n", rows);
  return operations.comments.empty() ? out : out + toml_line("comments", operations.comments);
}

std::string part_text(const PartDescription& part) {
  if (part.mesh.empty() && part.program.empty() && !part.operations && !part.judged) return {};
  std::string out = "\n[part]\n";
  if (!part.mesh.empty()) out += toml_line("mesh", part.mesh);
  if (part.move_mm != Vec3::Zero()) out += fmt::format("move_mm = {}\n", point_text(part.move_mm));
  if (!part.program.empty()) out += toml_line("program", part.program);
  if (part.operations) out += operations_text("part.operations", *part.operations);
  if (part.judged) out += operations_text("part.judged", *part.judged);
  return out;
}

std::string compensation_text(const CompensationSettings& c) {
  std::string out = "\n[compensation]\n" + toml_lines<CompensationSettings>(kCompensationKeys, c);
  out += toml_line("max_rounds", c.max_rounds, kAsIs);
  out += toml_line("reference", kReferenceWords[c.reference == Reference::machine ? 1 : 0]);
  out += toml_line("goal", kGoalWords[c.goal == Goal::tolerance ? 1 : 0]);
  std::vector<std::string_view> levers;
  for (const Lever lever : c.levers) levers.push_back(kLeverWords[static_cast<std::size_t>(lever)]);
  if (!levers.empty()) out += fmt::format("levers = [\"{}\"]\n", fmt::join(levers, "\", \""));
  if (c.time_budget_percent) out += toml_line("time_budget_percent", *c.time_budget_percent, kAsIs);
  if (c.profile_um) out += fmt::format("profile_um = [{}, {}]\n", (*c.profile_um)[0], (*c.profile_um)[1]);
  if (c.work_offset_mm) out += fmt::format("work_offset_mm = {}\n", point_text(*c.work_offset_mm));
  return c.operations.given() ? out + operations_text("compensation.operations", c.operations) : out;
}

std::string adapt_text(const AdaptSettings& a) {
  std::string limits;
  for (const LimitKey& k : kLimitKeys)
    if (const auto& value = a.limits.*k.field)
      limits += fmt::format("{}{} = {}", limits.empty() ? "" : ", ", k.key, toml_number(*value, k.unit));
  std::string out = fmt::format("\n[adapt]\nlimits = {{ {} }}\n", limits);
  if (a.levers != AdaptSettings{}.levers) {
    std::vector<std::string_view> levers;
    for (const AdaptLever lever : a.levers) levers.push_back(kAdaptLeverWords[static_cast<std::size_t>(lever)]);
    out += fmt::format("levers = [\"{}\"]\n", fmt::join(levers, "\", \""));
  }
  if (a.highest_feed_mm_per_s > 0)
    out += fmt::format("feed_mm_per_min = [{}, {}]\n", toml_number(a.lowest_feed_mm_per_s, kPerMinute),
                       toml_number(a.highest_feed_mm_per_s, kPerMinute));
  if (a.spindle_rpm) out += fmt::format("spindle_rpm = [{}, {}]\n", (*a.spindle_rpm)[0], (*a.spindle_rpm)[1]);
  return out + toml_lines<AdaptSettings>(kAdaptKeys, a);
}

std::string box_text(const Box& box) { return fmt::format("[{}, {}]", point_text(box.min_mm), point_text(box.max_mm)); }

std::string workpiece_text(const Workpiece& w) {
  std::string out = "\n[workpiece]\n" + toml_line("youngs_modulus_GPa", w.youngs_modulus_MPa, kGigapascals);
  std::string boxes;
  for (const Box& box : w.fixed_boxes) boxes += (boxes.empty() ? "" : ", ") + box_text(box);
  if (!boxes.empty())
    out += fmt::format("fixed = [{}]\n", boxes);
  else
    out += toml_line("fixed", w.fixed_mesh.empty() ? "bottom" : w.fixed_mesh);
  return out + toml_lines<Workpiece>(kWorkpieceKeys, w);
}

}  // namespace

std::string tool_toml(const Tool& tool) { return tool_text(tool, {}); }

std::string to_toml(const Job& job) {
  const AssumedKeys assumed = assumed_keys(job.path);
  std::string out = toml_line("program", job.program) + toml_line("machine", job.machine_path);
  if (job.inch) out += toml_line("units", kUnitWords[*job.inch ? 1 : 0]);
  if (job.operations.given()) out += operations_text("operations", job.operations);
  for (const auto& [number, tool] : job.tools) out += tool_text(tool, assumed);
  out += "\n[material]\n" + material_text(job.material) + assumed_line(assumed, "material");
  out += stock_text(job.stock, assumed) + part_text(job.part);
  out += "\n[simulation]\n" + toml_lines<Simulation>(kSimulationKeys, job.simulation);
  out += toml_line("coupling", kCouplingWords[job.simulation.coupling == Coupling::rigid ? 0 : 1]);
  if (job.simulation.collisions)
    out += toml_line("collisions", kCollisionsWords[static_cast<std::size_t>(*job.simulation.collisions)]);
  if (job.simulation.max_memory_GB) out += toml_line("max_memory_GB", *job.simulation.max_memory_GB, kAsIs);
  out += compensation_text(job.compensation);
  if (job.adapt) out += adapt_text(*job.adapt);
  out += features_text(job.features, job.model_error);
  if (job.workpiece) out += workpiece_text(*job.workpiece);
  return out + modes_text(job.workpiece_modes, "workpiece");
}

}  // namespace camber::machine
