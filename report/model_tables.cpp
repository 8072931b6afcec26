#include "report/page_tables.h"

#include <cmath>
#include <filesystem>
#include <regex>
#include <sstream>

#include <fmt/format.h>
#include <zlib.h>

#include "base/diagnostics.h"
#include "base/numbers.h"
#include "base/units.h"
#include "machine/force_law.h"

namespace camber::report {
namespace {

using machine::Axis;
using machine::Job;
using machine::Tool;

constexpr double kAny = machine::kNoLimit;

std::string value_text(double value, int digits = 6) {
  if (std::isinf(value)) return "no limit";
  return fmt::format("{:.{}g}", value, digits);
}

/// Nothing where there is no such file.
std::optional<std::string> file_text(const std::string& path) {
  std::error_code ec;
  if (!std::filesystem::is_regular_file(path, ec)) return std::nullopt;
  return SourceText::read(path).text();
}

void add_file(TextTable& table, const std::string& what, const std::string& path) {
  if (path.empty()) return;
  const auto text = file_text(path);
  if (!text) return;
  const auto sum = crc32_z(0, reinterpret_cast<const Bytef*>(text->data()), text->size());
  table.rows.push_back({what, path, fmt::format("{} bytes", text->size()), fmt::format("{:08x}", sum)});
}

std::string corner_text(const machine::Corner& c) {
  switch (c.law) {
    case machine::CornerLaw::speed_difference:
      return fmt::format("speed difference, {} mm/min",
                         value_text(mm_per_min_from_mm_per_s(c.speed_difference_mm_per_s)));
    case machine::CornerLaw::angle:
      return fmt::format("angle, {} ms", value_text(1000 * c.time_s));
    case machine::CornerLaw::blend:
      return fmt::format("blend, {} mm", value_text(c.tolerance_mm));
    case machine::CornerLaw::radius:
      return fmt::format("radius of three points, {} mm/s2", value_text(c.acceleration_mm_per_s2));
    case machine::CornerLaw::exact_stop:
      break;
  }
  return "exact stop";
}

const char* type_name(machine::ToolType type) {
  switch (type) {
    case machine::ToolType::ball:
      return "ball";
    case machine::ToolType::flat:
      return "flat";
    case machine::ToolType::bull:
      return "bull";
    case machine::ToolType::drill:
      return "drill";
    case machine::ToolType::tapered_ball:
      return "tapered ball";
    case machine::ToolType::chamfer:
      return "chamfer";
    case machine::ToolType::general:
      break;
  }
  return "general";
}

/// The string that `file` is in [material]; empty: none. By hand: std::regex needs stack for each character.
std::string file_of_material(const std::string& text) {
  std::istringstream lines(text);
  bool in_material = false;
  for (std::string line; std::getline(lines, line);) {
    line.erase(0, std::min(line.find_first_not_of(" \t"), line.size()));
    if (line.starts_with("[")) in_material = line.starts_with("[material]");
    if (!in_material || !line.starts_with("file")) continue;
    const std::size_t equals = line.find_first_not_of(" \t", 4), open = line.find('"');
    if (equals == std::string::npos || line[equals] != '=' || open == std::string::npos) continue;
    const std::size_t close = line.find('"', open + 1);
    if (close != std::string::npos) return line.substr(open + 1, close - open - 1);
  }
  return {};
}

/// Where the material's coefficients were read: the job itself or the file that its [material] names.
std::string material_path(const Job& job) {
  const auto text = file_text(job.path);
  const std::string file = text ? file_of_material(*text) : "";
  if (file.empty()) return job.path;
  return (std::filesystem::path(job.path).parent_path() / file).lexically_normal().string();
}

}  // namespace

TextTable inputs_table(const Job& job) {
  TextTable table{"Inputs", {"", "file", "size", "CRC-32"}, {}, {}};
  add_file(table, "program", job.program);
  add_file(table, "job", job.path);
  add_file(table, "machine", job.machine_path);
  if (const std::string material = material_path(job); material != job.path) add_file(table, "material", material);
  add_file(table, "stock", job.stock.mesh);
  add_file(table, "stock", job.stock.vdb);
  add_file(table, "part", job.part.mesh);
  add_file(table, "target program", job.part.program);
  table.rows.push_back({"computed by", "camber " CAMBER_VERSION, "", ""});
  return table;
}

std::map<std::string, std::string> stated_errors(const std::string& path) {
  std::map<std::string, std::string> out;
  std::istringstream in(file_text(path).value_or(""));
  static const std::regex kLine(R"(#\s*(\w+):\s*\S+\s*\+-\s*(\S+).*)");
  std::string line;
  std::smatch found;
  while (std::getline(in, line))
    if (line.size() < 200 && std::regex_match(line, found, kLine)) out[found[1].str()] = found[2].str();
  return out;
}

TextTable material_table(const Job& job) {
  const machine::Material& m = job.material;
  const machine::ForceLawDescription& law = machine::description(m.law);
  TextTable table{"Material", {"coefficient", "value", "standard error", "unit"}, {}, {}};
  const auto errors = stated_errors(material_path(job));
  const auto add = [&](const std::string& name, double value, std::string_view unit) {
    const auto error = errors.find(name);
    table.rows.push_back(
        {name, value_text(value), error == errors.end() ? "not known" : "± " + error->second, std::string(unit)});
  };
  for (const auto& c : law.coefficients) add(std::string(c.key), m.*c.field, c.unit == "1" ? "" : c.unit);
  table.note = fmt::format("{}.", law.title);
  if (!m.preset.empty()) table.note += fmt::format(" Based on the preset {}.", m.preset);
  if (errors.empty()) table.note += " No standard errors are stated: the coefficients were not fitted by fit-force.";
  return table;
}

TextTable tools_table(const Job& job) {
  TextTable table{"Tools", {""}, {}, {}};
  const auto add = [&](const char* name, auto text_of) {
    std::vector<std::string> row{name};
    for (const auto& [number, tool] : job.tools) row.push_back(text_of(tool));
    table.rows.push_back(std::move(row));
  };
  for (const auto& [number, tool] : job.tools) table.columns.push_back(fmt::format("T{}", number));
  add("type", [](const Tool& t) { return std::string(type_name(t.type)); });
  add("diameter, mm", [](const Tool& t) { return value_text(t.diameter_mm); });
  add("flutes", [](const Tool& t) { return std::to_string(t.flutes); });
  add("helix, °", [](const Tool& t) { return value_text(deg_from_rad(t.helix_rad), 4); });
  add("overhang, mm", [](const Tool& t) { return value_text(t.overhang_mm); });
  add("effective diameter / diameter", [](const Tool& t) { return value_text(t.effective_diameter_ratio); });
  add("modulus of elasticity, GPa", [](const Tool& t) { return value_text(t.youngs_modulus_MPa / 1000); });
  add("root stiffness, N/µm", [](const Tool& t) {
    return t.root_stiffness_N_per_mm == kAny ? std::string("rigid") : value_text(t.root_stiffness_N_per_mm / 1000);
  });
  if (std::ranges::any_of(job.tools,
                          [](const auto& t) { return t.second.root_rotational_stiffness_Nmm_per_rad < kAny; }))
    add("root stiffness about axes across it, Nm/rad", [](const Tool& t) {
      const double k = t.root_rotational_stiffness_Nmm_per_rad;
      return k == kAny ? std::string("rigid") : value_text(k / 1000);
    });
  add("root stiffness along the axis, N/µm", [](const Tool& t) {
    return t.root_axial_stiffness_N_per_mm == kAny ? std::string("rigid")
                                                   : value_text(t.root_axial_stiffness_N_per_mm / 1000);
  });
  return table;
}

TextTable machine_table(const machine::Machine& machine) {
  TextTable table{"Machine", {"", "X", "Y", "Z", "unit"}, {}, {}};
  const auto add = [&](const char* name, double Axis::*field, double scale, const char* unit, double unset) {
    bool any = false;
    for (const Axis& a : machine.axis) any = any || a.*field != unset;
    if (!any) return;
    std::vector<std::string> row{name};
    for (const Axis& a : machine.axis) row.push_back(value_text(a.*field * scale));
    row.push_back(unit);
    table.rows.push_back(std::move(row));
  };
  add("largest velocity", &Axis::max_velocity_mm_per_s, 60, "mm/min", kAny);
  add("acceleration", &Axis::acceleration_mm_per_s2, 1, "mm/s²", kAny);
  add("jerk", &Axis::jerk_mm_per_s3, 1, "mm/s³", kAny);
  add("position loop gain", &Axis::position_gain_per_s, 1, "1/s", kAny);
  add("feed forward", &Axis::feed_forward_percent, 1, "%", 0);
  add("filter", &Axis::filter_s, 1000, "ms", 0);
  add("velocity loop", &Axis::velocity_lag_s, 1000, "ms", 0);
  add("stiffness", &Axis::stiffness_N_per_mm, 0.001, "N/µm", kAny);
  const machine::Control& c = machine.control;
  table.note = fmt::format("Corners: {}. Block processing time {} ms; period {} ms.", corner_text(c.corner),
                           value_text(1000 * c.block_time_s), value_text(1000 * c.period_s));
  return table;
}

TextTable simulation_table(const Job& job) {
  TextTable table{"Simulation", {}, {}, {}};
  table.rows = {{"voxel", value_text(job.simulation.voxel_mm) + " mm"},
                {"rotation step", value_text(deg_from_rad(job.simulation.rotation_step_rad), 4) + "°"},
                {"coupling", job.simulation.coupling == machine::Coupling::rigid ? "rigid" : "static"},
                {"stock allowance of the previous pass", value_text(job.stock.allowance_mm) + " mm"}};
  return table;
}

}  // namespace camber::report
