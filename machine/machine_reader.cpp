// machine.toml into a Machine.
#include <fmt/format.h>

#include <algorithm>

#include "machine/kinematics_reader.h"
#include "machine/machine_keys.h"
#include "machine/machine_presets.h"
#include "machine/source_parameters.h"
#include "machine/toml_table.h"

namespace camber::machine {
namespace {

void read_corner(TomlTable table, Corner& corner) {
  const auto law = table.required_choice("law", kCornerLawWords);
  read_numbers<Corner>(table, kCornerKeys, corner);
  table.finish();
  if (!law) return;
  corner.law = static_cast<CornerLaw>(*law);
  const std::string_view needed = kCornerLawKeys[*law];
  for (const auto& k : kCornerKeys) {
    const bool of_a_law = std::ranges::find(kCornerLawKeys, k.key) != kCornerLawKeys.end();
    if (k.key == needed && !table.has(k.key)) table.missing(k.key, k.range.wanted());
    if (of_a_law && k.key != needed && table.has(k.key))
      table.error_at_name(k.key,
                          fmt::format("{} does not belong to the corner law \"{}\"", k.key,
                                      kCornerLawWords[static_cast<std::size_t>(corner.law)]),
                          "key-unused");
  }
}

AccelerationTimes read_mode_law(TomlTable& table) {
  AccelerationTimes times;
  times.law = static_cast<AccelerationLaw>(table.choice("acceleration_law", kAccelerationLawWords, 0));
  read_numbers<AccelerationTimes>(table, kModeLawKeys, times);
  const char* needed = times.law == AccelerationLaw::exponential ? "time_constant_1_ms"
                       : times.law == AccelerationLaw::bell      ? "bell_time_ms"
                                                                 : nullptr;
  if (needed && !table.has(needed)) table.missing(needed, kNotNegative.wanted());
  return times;
}

/// A parameter set: the control's own values but for those that the table gives.
void read_mode(TomlTable table, const Control& control, std::string name, Machine& machine) {
  Control mode = control;
  read_numbers<Control>(table, kControlKeys, mode);
  if (auto corner = table.table("corner")) {
    mode.corner = {};
    read_corner(*corner, mode.corner);
  }
  if (table.has("acceleration_law")) mode.acceleration_law = read_mode_law(table);
  table.finish();
  machine.modes.emplace_back(std::move(name), mode);
}

void read_modes(TomlTable table, Machine& machine) {
  for (const std::string_view name : kModeNames)
    if (auto mode = table.table(name)) read_mode(*mode, machine.control, std::string(name), machine);
  table.finish();
}

void read_control(TomlTable table, Control& control) {
  control.kind_given = table.has("dialect");
  control.kind = control_kinds()[table.choice("dialect", control_kind_names(), 0)];
  read_numbers<Control>(table, kControlKeys, control);
  control.least_increment_mm = table.optional_number("least_increment_mm", kMinIncrementMm);
  if (table.has("whole_numbers"))
    control.whole_numbers_are_increments = table.choice("whole_numbers", kWholeNumberWords, 0) == 1;
  control.lookahead_blocks = static_cast<int>(table.number("lookahead_blocks", kBlockCount, control.lookahead_blocks));
  control.rotary_feed = static_cast<RotaryFeed>(
      table.choice("rotary_feed", kRotaryFeedWords, static_cast<std::size_t>(control.kind.rotary_feed)));
  control.joint_limits = table.boolean("joint_limits", control.kind.joint_limits);
  control.starts_on_period = table.boolean("starts_on_period", control.kind.starts_on_period);
  if (auto corner = table.table("corner")) read_corner(*corner, control.corner);
  table.ignore("mode");
  table.finish();
}

void read_axis(TomlTable table, Axis& axis) {
  axis.given = true;
  read_numbers<Axis>(table, kAxisKeys, axis);
  if (const auto travel = table.numbers("travel_mm", 2, kAnyNumberOrInf, "[least, greatest]")) {
    axis.travel_mm = {(*travel)[0], (*travel)[1]};
    if (!(axis.travel_mm[0] < axis.travel_mm[1]))
      table.error_at("travel_mm",
                     fmt::format("travel_mm goes from {} to {}; the second must be greater than the first",
                                 axis.travel_mm[0], axis.travel_mm[1]),
                     "value-range");
  }
  table.finish();
}

void read_axes(TomlTable table, Machine& machine) {
  for (std::size_t i = 0; i < machine.axis.size(); ++i)
    if (auto axis = table.table(kAxisNames[i])) read_axis(*axis, machine.axis[i]);
  read_rotary_axes(table, machine);
  table.finish();
}

void read_spindle(TomlTable table, Spindle& spindle) {
  read_numbers<Spindle>(table, kSpindleKeys, spindle);
  if (spindle.start_time_s > 0 && !table.has("max_rpm")) table.missing("max_rpm", kPositiveOrInf.wanted());
  for (const auto& k : kSpindleKeys)
    if (spindle.gd2_kgf_m2 > 0 && (k.key == "power_W" || k.key == "constant_torque_rpm") && !table.has(k.key))
      table.missing(k.key, k.range.wanted());
  if (spindle.constant_power_rpm < spindle.constant_torque_rpm && table.has("constant_power_rpm"))
    table.error_at("constant_power_rpm",
                   fmt::format("constant_power_rpm is {}; at least constant_torque_rpm, {}, was expected",
                               spindle.constant_power_rpm, spindle.constant_torque_rpm),
                   "value-range");
  table.finish();
}

void read_cycle(TomlTable table, Cycle& cycle) {
  cycle.rapid_path =
      static_cast<RapidPath>(table.choice("rapid_path", kRapidPathWords, static_cast<std::size_t>(cycle.rapid_path)));
  cycle.acceleration_law = static_cast<AccelerationLaw>(table.choice("acceleration_law", kAccelerationLawWords, 0));
  cycle.code_order = static_cast<CodeOrder>(table.choice("code_order", kCodeOrderWords, 0));
  read_numbers<Cycle>(table, kCycleKeys, cycle);
  if (cycle.acceleration_law == AccelerationLaw::exponential && !table.has("time_constant_1_ms"))
    table.missing("time_constant_1_ms", kNotNegative.wanted());
  if (cycle.acceleration_law == AccelerationLaw::bell && !table.has("bell_time_ms"))
    table.missing("bell_time_ms", kNotNegative.wanted());
  table.finish();
}

/// Two numbers, the second not the smaller one; without the key both are 0 (nothing of the kind was seen).
void read_range(TomlTable& table, std::string_view key, const FileUnit& unit, std::array<double, 2>& range) {
  const auto numbers = table.numbers(key, 2, kNotNegativeOrInf, "[least, greatest]");
  if (!numbers) return;
  range = {unit.inside_from_file((*numbers)[0]), unit.inside_from_file((*numbers)[1])};
  if (range[0] > range[1])
    table.error_at(key,
                   fmt::format("{} goes from {} to {}; the second must not be less than the first", key, (*numbers)[0],
                               (*numbers)[1]),
                   "value-range");
}

void read_fitted_range(TomlTable table, FittedRange& range) {
  range.known = true;
  read_range(table, "feed_mm_per_min", kPerMinute, range.feed_mm_per_s);
  read_range(table, "corner_degrees", kDegrees, range.corner_rad);
  read_range(table, "line_mm", kAsIs, range.line_mm);
  read_range(table, "arc_radius_mm", kAsIs, range.arc_radius_mm);
  read_range(table, "arc_mm", kAsIs, range.arc_mm);
  read_range(table, "blocks_per_s", kAsIs, range.blocks_per_s);
  const std::string axes = table.text("axes", "xyz");
  for (std::size_t i = 0; i < range.axis.size(); ++i) range.axis[i] = axes.find(kAxisNames[i]) != std::string::npos;
  table.finish();
}

void read_reference_points(TomlTable table, Machine& machine) {
  for (std::size_t i = 0; i < kReferencePointNames.size(); ++i)
    if (auto point = table.table(kReferencePointNames[i])) {
      read_numbers<ReferencePoint>(*point, kReferencePointKeys, machine.reference_points[i]);
      point->finish();
    }
  table.finish();
}

SourceText text_of(const std::string& path) {
  if (!is_preset(path)) return SourceText::read(path);
  const MachinePreset* preset = find_machine_preset(path);
  if (preset == nullptr) fail_on_file(path, unknown_machine_preset(path), "machine-preset");
  return {path, machine_preset_text(*preset)};
}

}  // namespace

Machine read_machine(const std::string& path, Diagnostics& diagnostics) {
  Machine machine;
  machine.path = path;
  const auto file = parse_toml(text_of(path), "a machine description ([control], [axis.x] ...)", diagnostics);
  diagnostics.throw_if_errors();
  TomlTable top = TomlTable::top(*file, diagnostics);
  top.ignore("assumed");  // assumptions.h
  for (Axis& axis : machine.axis) axis.given = false;
  if (auto source = top.table("source")) read_source(*source, machine);
  bool width_given = false;
  if (auto control = top.table("control")) {
    width_given = control->has("in_position_mm");
    read_control(*control, machine.control);
    if (auto modes = control->table("mode")) read_modes(*modes, machine);
  }
  if (!width_given && machine.control.kind.waits_in_position) machine.control.in_position_mm = kInPositionMm;
  if (auto axes = top.table("axis")) read_axes(*axes, machine);
  if (auto kinematics = top.table("kinematics")) read_kinematics(*kinematics, machine);
  read_bodies(top, machine);
  if (auto spindle = top.table("spindle")) read_spindle(*spindle, machine.spindle);
  machine.cycle.rapid_path = machine.control.kind.rapid_path;
  if (auto cycle = top.table("cycle")) read_cycle(*cycle, machine.cycle);
  if (auto change = top.table("tool_change")) {
    read_numbers<ToolChange>(*change, kToolChangeKeys, machine.tool_change);
    change->finish();
  }
  if (auto points = top.table("reference_point")) read_reference_points(*points, machine);
  if (auto index = top.table("index")) {
    machine.index.present = true;
    read_numbers<IndexTable>(*index, kIndexKeys, machine.index);
    index->finish();
  }
  check_kinematics(top, machine);
  if (auto range = top.table("fitted_range")) read_fitted_range(*range, machine.fitted_range);
  top.finish();
  diagnostics.throw_if_errors();
  return machine;
}

}  // namespace camber::machine
