#include "kinematics/control_options.h"

#include <algorithm>
#include <cassert>
#include <cctype>
#include <cmath>

#include "machine/control_kinds.h"
#include "machine/machine_presets.h"
#include "nc/dialects.h"
#include "nc/emit/number_style.h"

namespace camber::kinematics {
namespace {

constexpr bool has_dialect(const machine::ControlKind& kind) {
  return std::ranges::count(nc::kDialects, kind.nc_dialect, &nc::Dialect::name) == 1;
}

constexpr bool has_unique_name(const machine::ControlKind& kind) {
  return !kind.name.empty() && std::ranges::count(machine::kControlKinds, kind.name, &machine::ControlKind::name) == 1;
}

constexpr bool has_control(const nc::Dialect& dialect) {
  return std::ranges::count(machine::kControlKinds, dialect.name, &machine::ControlKind::nc_dialect) > 0;
}

static_assert(std::ranges::all_of(machine::kControlKinds, has_dialect), "nc_dialect must name a row of nc/dialects.h");
static_assert(std::ranges::all_of(machine::kControlKinds, has_unique_name), "names of controls must be unique");
static_assert(std::ranges::all_of(nc::kDialects, has_control), "every dialect must belong to a control");

}  // namespace

const nc::Dialect& dialect_of(const machine::ControlKind& kind) {
  const nc::Dialect* dialect = nc::dialect_named(kind.nc_dialect);
  assert(dialect);
  return *dialect;
}

nc::InterpreterOptions interpreter_options(const machine::Machine& machine, std::optional<bool> inch) {
  nc::InterpreterOptions options;
  options.inch = inch;
  return interpreter_options(machine, options);
}

nc::InterpreterOptions interpreter_options(const machine::Machine& machine, nc::InterpreterOptions given) {
  // Presets belong to no control: their programs are read in the dialect that the text shows.
  if (!machine::is_preset(machine.path)) {
    given.dialect = dialect_of(machine.control.kind);
    given.dwell_p_is_ms = given.dialect->dwell_p_is_ms;
  }
  if (!given.whole_numbers_are_increments)
    given.whole_numbers_are_increments = machine.control.whole_numbers_are_increments;
  // Of a control that nobody named nothing is said: numbers count units.
  if (!given.whole_numbers_are_increments && !machine.control.kind_given) given.whole_numbers_are_increments = false;
  given.max_spindle_speed_rpm = machine.spindle.max_rpm;
  for (int i = 0; i < 3; ++i) given.single_direction_mm[i] = machine.axis[i].g60_mm;
  return given;
}

std::vector<nc::RotaryOption> rotary_options(const machine::Machine& machine) {
  std::vector<nc::RotaryOption> out;
  for (const char letter : {'a', 'b', 'c'}) {
    if (machine.kinematics.chain.find(letter) == std::string::npos) continue;
    const machine::RotaryAxis& axis = machine.rotary[static_cast<std::size_t>(letter - 'a')];
    out.push_back({.letter = static_cast<char>(std::toupper(letter)),
                   .on_table = machine.kinematics.chain.find(letter) < machine.kinematics.table_axes,
                   .shortest_way = axis.shortest_way,
                   .clamp_m = axis.clamp_m,
                   .unclamp_m = axis.unclamp_m});
  }
  return out;
}

nc::EmitOptions decimals_for(const machine::Control& control, const nc::Program& program) {
  constexpr int kFewest = 3, kMax = 4;  // millimetres
  nc::EmitOptions out;
  if (control.least_increment_mm) {
    out.decimals_mm = std::max(0, static_cast<int>(std::ceil(-std::log10(*control.least_increment_mm) - 1e-9)));
    out.decimals_inch = out.decimals_mm + 1;
  } else {
    const int own = nc::coordinate_decimals_of(program);
    out.decimals_mm = std::clamp(own, kFewest, kMax);
    out.decimals_inch = std::clamp(own, kFewest + 1, kMax + 1);
  }
  return out;
}

}  // namespace camber::kinematics
