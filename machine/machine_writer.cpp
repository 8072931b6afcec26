// A Machine as machine.toml.
#include <fmt/format.h>

#include <algorithm>

#include "machine/kinematics_reader.h"
#include "machine/machine_keys.h"
#include "machine/machine_presets.h"

namespace camber::machine {
namespace {

std::string corner_text(const Corner& corner) {
  std::string out = fmt::format("corner = {{ law = \"{}\"", kCornerLawWords[static_cast<std::size_t>(corner.law)]);
  const Corner defaults;
  for (const auto& k : kCornerKeys) {
    const bool of_this_law = kCornerLawKeys[static_cast<std::size_t>(corner.law)] == k.key;
    const bool of_no_law = std::ranges::find(kCornerLawKeys, k.key) == kCornerLawKeys.end();
    if (of_this_law || (of_no_law && corner.*k.field != defaults.*k.field))
      out += fmt::format(", {} = {}", k.key, toml_number(corner.*k.field, k.unit));
  }
  return out + " }\n";
}

std::string mode_text(std::string_view name, const Control& mode) {
  std::string out = fmt::format("\n[control.mode.{}]\n", name) + toml_lines<Control>(kControlKeys, mode);
  if (mode.acceleration_law)
    out += toml_line("acceleration_law", kAccelerationLawWords[static_cast<std::size_t>(mode.acceleration_law->law)]) +
           toml_lines<AccelerationTimes>(kModeLawKeys, *mode.acceleration_law);
  return out + corner_text(mode.corner);
}

/// Empty for an axis that is not given, unless something has set a number of it since.
std::string axis_text(std::string_view name, const Axis& axis) {
  if (!axis.given && toml_lines<Axis>(kAxisKeys, axis) == toml_lines<Axis>(kAxisKeys, Axis{})) return {};
  return fmt::format("\n[axis.{}]\n{}travel_mm = [{}, {}]\n", name, toml_lines<Axis>(kAxisKeys, axis),
                     toml_number(axis.travel_mm[0], kAsIs), toml_number(axis.travel_mm[1], kAsIs));
}

std::string cycle_text(const Cycle& cycle) {
  std::string out = "\n[cycle]\n";
  out += toml_line("rapid_path", kRapidPathWords[static_cast<std::size_t>(cycle.rapid_path)]);
  out += toml_line("acceleration_law", kAccelerationLawWords[static_cast<std::size_t>(cycle.acceleration_law)]);
  out += toml_line("code_order", kCodeOrderWords[static_cast<std::size_t>(cycle.code_order)]);
  return out + toml_lines<Cycle>(kCycleKeys, cycle);
}

std::string range_text(std::string_view key, const std::array<double, 2>& range, const FileUnit& unit) {
  return fmt::format("{} = [{}, {}]\n", key, toml_number(range[0], unit), toml_number(range[1], unit));
}

std::string fitted_range_text(const FittedRange& r) {
  if (!r.known) return {};
  std::string axes;
  for (std::size_t i = 0; i < r.axis.size(); ++i)
    if (r.axis[i]) axes += kAxisNames[i];
  return "\n[fitted_range]\n" + range_text("feed_mm_per_min", r.feed_mm_per_s, kPerMinute) +
         range_text("corner_degrees", r.corner_rad, kDegrees) + range_text("line_mm", r.line_mm, kAsIs) +
         range_text("arc_radius_mm", r.arc_radius_mm, kAsIs) +
         (r.arc_mm[1] > 0 ? range_text("arc_mm", r.arc_mm, kAsIs) : "") +
         range_text("blocks_per_s", r.blocks_per_s, kAsIs) + toml_line("axes", axes);
}

}  // namespace

std::string to_toml(const Machine& machine) {
  std::string out = is_preset(machine.path) ? toml_line("assumed", machine.path) : "";
  out += "[control]\n";
  if (!is_preset(machine.path)) out += toml_line("dialect", machine.control.kind.name);
  out += toml_lines<Control>(kControlKeys, machine.control);
  out += toml_line("lookahead_blocks", machine.control.lookahead_blocks, kAsIs);
  if (machine.control.least_increment_mm)
    out += toml_line("least_increment_mm", *machine.control.least_increment_mm, kAsIs);
  if (machine.control.whole_numbers_are_increments)
    out += toml_line("whole_numbers", kWholeNumberWords[*machine.control.whole_numbers_are_increments ? 1 : 0]);
  if (machine.kinematics.given())
    out += toml_line("rotary_feed", kRotaryFeedWords[static_cast<std::size_t>(machine.control.rotary_feed)]) +
           fmt::format("joint_limits = {}\n", machine.control.joint_limits);
  if (machine.control.starts_on_period != machine.control.kind.starts_on_period)
    out += fmt::format("starts_on_period = {}\n", machine.control.starts_on_period);
  out += corner_text(machine.control.corner);
  for (const auto& [name, mode] : machine.modes) out += mode_text(name, mode);
  for (std::size_t i = 0; i < machine.axis.size(); ++i) out += axis_text(kAxisNames[i], machine.axis[i]);
  for (std::size_t i = 0; i < machine.rotary.size(); ++i)
    out += rotary_axis_text(kRotaryAxisNames[i], machine.rotary[i]);
  out += kinematics_text(machine.kinematics);
  out += "\n[spindle]\n" + toml_lines<Spindle>(kSpindleKeys, machine.spindle);
  out += cycle_text(machine.cycle);
  out += "\n[tool_change]\n" + toml_lines<ToolChange>(kToolChangeKeys, machine.tool_change);
  for (std::size_t i = 0; i < machine.reference_points.size(); ++i)
    if (const ReferencePoint& point = machine.reference_points[i]; point != ReferencePoint{})
      out += fmt::format("\n[reference_point.{}]\n", kReferencePointNames[i]) +
             toml_lines<ReferencePoint>(kReferencePointKeys, point);
  if (machine.index.present) out += "\n[index]\n" + toml_lines<IndexTable>(kIndexKeys, machine.index);
  for (const Body& body : machine.bodies) out += body_text(body);
  out += fitted_range_text(machine.fitted_range);
  return out;
}

}  // namespace camber::machine
