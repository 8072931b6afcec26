#include "machine/source_parameters.h"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "base/numbers.h"
#include "base/units.h"
#include "machine/machine_keys.h"

namespace camber::machine {
namespace {

/// One native parameter of the axes.
struct AxisParameter {
  std::string_view native, unit;  ///< as the control's manual has it
  double Axis::*field;
  double inside_factor;
  std::string_view key;  ///< key of [axis.x]
  double key_factor;     ///< from inside
};

constexpr std::array kFanuc{
    AxisParameter{"1825", "0.01/s", &Axis::position_gain_per_s, 0.01, "position_gain_per_s", 1},
    AxisParameter{"1420", "mm/min", &Axis::max_velocity_mm_per_s, 1.0 / 60, "max_velocity_mm_per_min", 60},
};
constexpr std::array kSinumerik{
    AxisParameter{"MD32000", "mm/min", &Axis::max_velocity_mm_per_s, 1.0 / 60, "max_velocity_mm_per_min", 60},
    AxisParameter{"MD32200", "(m/min)/mm", &Axis::position_gain_per_s, 1000.0 / 60, "position_gain_per_s", 1},
    AxisParameter{"MD32300", "m/s2", &Axis::acceleration_mm_per_s2, 1000, "acceleration_mm_per_s2", 1},
    AxisParameter{"MD32431", "m/s3", &Axis::jerk_mm_per_s3, 1000, "jerk_mm_per_s3", 1},
};

void set_axis(Machine& machine, const AxisParameter& p, int axis, double native, const std::string& where) {
  machine.axis[axis].*p.field = native * p.inside_factor;
  machine.axis[axis].given = true;
  machine.translation.push_back(fmt::format("{} = {:g} {}: axis.{}.{} = {:g}", where, native, p.unit, kAxisNames[axis],
                                            p.key, native * p.inside_factor * p.key_factor));
}

/// One number for all axes, or one for each.
void read_axes(TomlTable& table, std::string_view control, const AxisParameter& p, Machine& machine) {
  if (!table.has(p.native)) return;
  std::optional<std::vector<double>> list;
  if (table.is_list(p.native)) {
    list = table.numbers(p.native, 3, kPositive, "one number, or one for each of x, y and z");
  } else if (const auto number = table.optional_number(p.native, kPositive)) {
    list = std::vector<double>(3, *number);
  }
  if (!list) return;
  for (int axis = 0; axis < 3; ++axis)
    set_axis(machine, p, axis, (*list)[axis], fmt::format("{} {}", control, p.native));
}

void read_fanuc(TomlTable table, Machine& machine) {
  for (const AxisParameter& p : kFanuc) read_axes(table, "fanuc", p, machine);
  if (const auto difference = table.optional_number("1783", kPositive)) {
    machine.control.corner.law = CornerLaw::speed_difference;
    machine.control.corner.speed_difference_mm_per_s = mm_per_s_from_mm_per_min(*difference);
    machine.translation.push_back(
        fmt::format("fanuc 1783 = {0:g} mm/min: control.corner = {{ law = \"speed_difference\", "
                    "speed_difference_mm_per_min = {0:g} }}",
                    *difference));
  }
  table.finish();
}

using Ini = std::map<std::string, std::string>;  // "SECTION.KEY"

std::string trimmed(std::string text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.pop_back();
  std::size_t at = 0;
  while (at < text.size() && std::isspace(static_cast<unsigned char>(text[at]))) ++at;
  return text.substr(at);
}

Ini read_ini(const std::string& path) {
  const SourceText source = SourceText::read(path);
  Ini ini;
  std::string section;
  for (std::size_t i = 1; i <= source.line_count(); ++i) {
    std::string line = trimmed(std::string(source.line(i)));
    line = trimmed(line.substr(0, line.find_first_of("#;")));
    if (line.empty()) continue;
    const std::size_t equals = line.find('=');
    if (line.front() == '[' && line.back() == ']') {
      section = line.substr(1, line.size() - 2);
    } else if (equals != line.npos) {
      ini.try_emplace(section + "." + trimmed(line.substr(0, equals)), trimmed(line.substr(equals + 1)));
    }
  }
  return ini;
}

class IniReader {
 public:
  IniReader(const Ini& ini, Machine& machine) : ini_(ini), machine_(machine) {}

  void read() {
    const auto units = ini_.find("TRAJ.LINEAR_UNITS");
    const bool inch = units != ini_.end() && (units->second == "inch" || units->second == "in");
    const double mm = inch ? 25.4 : 1.0;
    const std::string unit = inch ? "inch" : "mm";
    const std::string speed_unit = unit + "/s", acceleration_unit = unit + "/s2";
    for (int i = 0; i < 3; ++i) {
      axis(i, {"MAX_VELOCITY", speed_unit, &Axis::max_velocity_mm_per_s, mm, "max_velocity_mm_per_min", 60});
      axis(i, {"MAX_ACCELERATION", acceleration_unit, &Axis::acceleration_mm_per_s2, mm, "acceleration_mm_per_s2", 1});
    }
    if (const auto period_ns = number("EMCMOT.SERVO_PERIOD")) {
      machine_.control.period_s = *period_ns * 1e-9;
      tell("EMCMOT.SERVO_PERIOD", "ns", "control.period_ms", *period_ns * 1e-6);
    }
    if (const auto depth = number("TRAJ.ARC_BLEND_OPTIMIZATION_DEPTH")) {
      machine_.control.lookahead_blocks = static_cast<int>(*depth);
      tell("TRAJ.ARC_BLEND_OPTIMIZATION_DEPTH", "", "control.lookahead_blocks", *depth);
    }
    if (const auto ratio = number("TRAJ.ARC_BLEND_KINK_RATIO")) {
      machine_.control.corner.step_fraction = *ratio;
      tell("TRAJ.ARC_BLEND_KINK_RATIO", "", "control.corner.step_share", *ratio);
    }
  }

 private:
  std::optional<double> number(const std::string& key) const {
    const auto at = ini_.find(key);
    const auto value = at == ini_.end() ? std::nullopt : parse_number(at->second);
    return value && *value > 0 ? value : std::nullopt;
  }

  void axis(int i, const AxisParameter& p) {
    for (const std::string& section : {fmt::format("AXIS_{}", "XYZ"[i]), fmt::format("JOINT_{}", i)}) {
      const auto value = number(fmt::format("{}.{}", section, p.native));
      if (!value) continue;
      set_axis(machine_, p, i, *value, fmt::format("linuxcnc [{}]{}", section, p.native));
      return;
    }
  }

  void tell(const std::string& key, std::string_view unit, std::string_view ours, double value) {
    const std::size_t dot = key.find('.');
    machine_.translation.push_back(fmt::format("linuxcnc [{}]{} = {}{}{}: {} = {:g}", key.substr(0, dot),
                                               key.substr(dot + 1), ini_.at(key), unit.empty() ? "" : " ", unit, ours,
                                               value));
  }

  const Ini& ini_;
  Machine& machine_;
};

void read_linuxcnc(TomlTable table, Machine& machine) {
  const std::string file = table.required_text("ini");
  table.finish();
  if (file.empty()) return;
  const std::filesystem::path path = std::filesystem::path(machine.path).parent_path() / file;
  if (!std::filesystem::is_regular_file(path)) {
    table.error_at("ini", fmt::format("ini is \"{}\", which is no file beside {}", file, machine.path), "source-ini");
    return;
  }
  const std::size_t before = machine.translation.size();
  IniReader(read_ini(path.string()), machine).read();
  if (machine.translation.size() == before)
    table.error_at("ini", fmt::format("\"{}\" has no MAX_VELOCITY, MAX_ACCELERATION or SERVO_PERIOD", file),
                   "source-ini");
}

}  // namespace

void read_source(TomlTable table, Machine& machine) {
  if (auto fanuc = table.table("fanuc")) read_fanuc(*fanuc, machine);
  if (auto sinumerik = table.table("sinumerik")) {
    for (const AxisParameter& p : kSinumerik) read_axes(*sinumerik, "sinumerik", p, machine);
    sinumerik->finish();
  }
  if (auto linuxcnc = table.table("linuxcnc")) read_linuxcnc(*linuxcnc, machine);
  table.finish();
}

}  // namespace camber::machine
