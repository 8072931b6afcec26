// A Job as job.toml, with every default filled in.
#include <fmt/format.h>

#include "machine/job_keys.h"
#include "machine/material_reader.h"

namespace camber::machine {
namespace {

std::string tool_text(const Tool& tool) {
  std::string out = fmt::format("\n[tool.{}]\n", tool.number);
  out += toml_line("type", kToolTypeWords[static_cast<std::size_t>(tool.type)]);
  out += toml_line("flutes", tool.flutes, kAsIs) + toml_lines<Tool>(kToolKeys, tool);
  if (tool.type == ToolType::bull) out += toml_line("corner_radius_mm", tool.corner_radius_mm, kAsIs);
  if (tool.flute_length_mm) out += toml_line("flute_length_mm", *tool.flute_length_mm, kAsIs);
  if (tool.shank_diameter_mm > 0) out += toml_line("shank_diameter_mm", tool.shank_diameter_mm, kAsIs);
  return out;
}

std::string point_text(const Vec3& p) {
  return fmt::format("[{}, {}, {}]", toml_number(p.x(), kAsIs), toml_number(p.y(), kAsIs), toml_number(p.z(), kAsIs));
}

std::string stock_text(const Stock& stock) {
  std::string out = "\n[stock]\n";
  if (stock.box)
    out += fmt::format("box_mm = [{}, {}]\n", point_text(stock.box->min_mm), point_text(stock.box->max_mm));
  if (!stock.mesh.empty()) out += toml_line("mesh", stock.mesh);
  return out + toml_line("allowance_mm", stock.allowance_mm, kAsIs);
}

std::string part_text(const Part& part) {
  if (part.mesh.empty() && part.program.empty()) return {};
  std::string out = "\n[part]\n";
  if (!part.mesh.empty()) out += toml_line("mesh", part.mesh);
  if (!part.program.empty()) out += toml_line("program", part.program);
  return out;
}

std::string operations_text(const Operations& operations) {
  if (operations.tools.empty() && operations.blocks.empty()) return {};
  std::string out = "\n[operations]\n";
  if (!operations.tools.empty()) out += fmt::format("tools = [{}]\n", fmt::join(operations.tools, ", "));
  std::string rows;
  for (const auto& b : operations.blocks) rows += fmt::format("{}[{}, {}]", rows.empty() ? "" : ", ", b[0], b[1]);
  return rows.empty() ? out : out + fmt::format("blocks = [{}]\n", rows);
}

}  // namespace

std::string to_toml(const Job& job) {
  std::string out = toml_line("program", job.program) + toml_line("machine", job.machine_path);
  if (job.inch) out += toml_line("units", kUnitWords[*job.inch ? 1 : 0]);
  out += operations_text(job.operations);
  for (const auto& [number, tool] : job.tools) out += tool_text(tool);
  out += "\n[material]\n" + material_text(job.material);
  out += stock_text(job.stock) + part_text(job.part);
  out += "\n[simulation]\n" + toml_lines<Simulation>(kSimulationKeys, job.simulation);
  out += toml_line("coupling", kCouplingWords[job.simulation.coupling == Coupling::rigid ? 0 : 1]);
  out += "\n[compensation]\n" + toml_lines<Compensation>(kCompensationKeys, job.compensation);
  return out + toml_line("max_rounds", job.compensation.max_rounds, kAsIs);
}

}  // namespace camber::machine
