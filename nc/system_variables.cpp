#include "nc/system_variables.h"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"

namespace camber::nc {
namespace {

bool within(int number, int first, int last) { return number >= first && number <= last; }

double work_offset_code(const Dialect& dialect, int work_offset) {
  return work_offset > 540000 ? (dialect.haas_work_offsets ? 154 : 54.1)
         : work_offset > 100  ? work_offset / 10.0
                              : work_offset;
}

}  // namespace

double SystemVariables::position(int axis) const {
  const MachineFacts f = interpreter_.facts();
  return axis < 3 ? f.position_mm[axis] / f.unit_mm : 0;
}

bool SystemVariables::owns(int number) const {
  if (dialect_.system_4000) return false;
  return number >= 5061 && number <= 5428;
}

Value SystemVariables::get(int number, std::size_t offset) {
  return dialect_.system_4000 ? fanuc(number, offset) : linuxcnc(number, offset);
}

Value SystemVariables::not_known(int number, std::size_t offset, const char* what) {
  report_.warning(offset, "variable",
                  fmt::format("#{} ({}) is known only at the machine; it is taken as 0", number, what), what);
  return 0.0;
}

double SystemVariables::clock_s() {
  for (; timed_moves_ < out_.moves.size(); ++timed_moves_) {
    const Move& m = out_.moves[timed_moves_];
    timed_s_ += m.dwell_s;
    if (m.feed_mm_per_s > 0) timed_s_ += length_mm(out_, m) / m.feed_mm_per_s;
  }
  return timed_s_ + 0.001 * static_cast<double>(ticks_);
}

Value SystemVariables::fanuc(int number, std::size_t offset) {
  if (number == 3001) return 1000 * (clock_s() - clock_3001_);
  if (number == 3002) return (clock_s() - clock_3002_) / 3600;
  if (within(number, 4001, 4399)) return modal(number % 200);
  if (within(number, 5001, 5020)) return position(number - 5001);
  if (within(number, 5041, 5060)) return position(number - 5041);
  if (within(number, 5021, 5040) || within(number, 5061, 5080)) {
    report_.warning(offset, "variable",
                    fmt::format("#{} ({} position) is known only at the machine; the work position is taken", number,
                                number < 5061 ? "machine" : "skip"),
                    "machine position");
    return position((number - 1) % 20);
  }
  if (within(number, 3003, 3007) || within(number, 3008, 3010)) return 0.0;
  if (within(number, 1000, 1199)) return not_known(number, offset, "signal");
  if (const auto value = offset_value(number, offset)) return *value;
  if (within(number, 2000, 2999) || within(number, 10001, 19999)) return not_known(number, offset, "tool offset");
  if (within(number, 3011, 3012)) return not_known(number, offset, "date or time");
  if (within(number, 3901, 3902)) return not_known(number, offset, "number of parts");
  if (within(number, 5081, 5100)) return not_known(number, offset, "tool length");
  if (within(number, 5101, 5120)) return not_known(number, offset, "servo position error");
  if (within(number, 5201, 5400) || within(number, 7001, 7960) || within(number, 14001, 14999))
    return not_known(number, offset, "work offset");
  throw MacroError(offset, "variable",
                   fmt::format("there is no variable #{} on a {} control that Camber knows", number, dialect_.name));
}

/// Returns nothing where the variable is no offset.
std::optional<Value> SystemVariables::offset_value(int number, std::size_t offset) {
  const auto variable = offset_variable(dialect_, number);
  if (!variable) return std::nullopt;
  const bool work = variable->kind == OffsetVariable::Kind::work || variable->kind == OffsetVariable::Kind::external;
  const auto value = interpreter_.offset_value(*variable);
  if (!value) return not_known(number, offset, work ? "work offset" : "tool offset");
  return Value(work && variable->axis >= 3 ? *value : *value / interpreter_.facts().unit_mm);
}

/// Sets an offset by its variable; false where the variable is none.
bool SystemVariables::set_offset(int number, Value value, std::size_t offset) {
  const auto variable = offset_variable(dialect_, number);
  if (!variable) return false;
  const bool work = variable->kind == OffsetVariable::Kind::work || variable->kind == OffsetVariable::Kind::external;
  const double unit = work && variable->axis >= 3 ? 1 : interpreter_.facts().unit_mm;
  interpreter_.set_offset(*variable, value.value_or(0) * unit, offset);
  return true;
}

/// number: 4001 .. 4130, or a set of 200 higher, less 4000 (see the caller's modulo).
Value SystemVariables::modal(int number) const {
  const MachineFacts f = interpreter_.facts();
  const ModalState& s = *f.state;
  const double inch = s.inch ? 1 : 0;
  switch (number) {
    case 1:
      return f.motion_g;
    case 2:
      return f.plane_g;
    case 3:
      return s.incremental ? 91.0 : 90.0;
    case 5:
      return s.feed_mode == FeedMode::inverse_time ? 93.0 : s.feed_mode == FeedMode::per_minute ? 94.0 : 95.0;
    case 6:
      return 21.0 - inch;
    case 7:
      return 40.0;
    case 8:
      return 49.0;
    case 9:
      return f.cycle_g == 0 ? 80.0 : f.cycle_g;
    case 10:
      return f.return_to_r ? 99.0 : 98.0;
    case 14:
      return work_offset_code(dialect_, s.work_offset);
    case 15:
      return s.path_control == PathControl::blend ? 64.0 : 61.0;
    case 109:
      return f.feed;
    case 119:
      return s.spindle_speed_rpm;
    case 120:
      return static_cast<double>(std::max(f.selected_tool, 0));
    case 130:
      return s.work_offset > 540000 ? s.work_offset - 540000.0 : 0.0;
    default:
      return 0.0;
  }
}

Value SystemVariables::linuxcnc(int number, std::size_t offset) {
  if (const auto variable = offset_variable(dialect_, number)) {
    const double value = interpreter_.offset_value(*variable).value_or(0);
    return variable->axis < 3 ? value / interpreter_.facts().unit_mm : value;
  }
  if (within(number, 5420, 5428)) return position(number - 5420);
  const MachineFacts f = interpreter_.facts();
  if (number == 5220) {
    const int w = f.state->work_offset;
    return w > 590 && w < 600 ? w - 584.0 : within(w, 54, 59) ? w - 53.0 : 1.0;
  }
  if (number == 5400) return static_cast<double>(f.state->tool);
  if (within(number, 5061, 5419)) return 0.0;
  throw MacroError(offset, "variable", fmt::format("there is no variable #{}; 1 to 5602 was expected", number));
}

Value SystemVariables::get(const std::string& name) const {
  if (name.front() != '_') return std::nullopt;
  const MachineFacts f = interpreter_.facts();
  const ModalState& s = *f.state;
  const auto flag = [](bool on) { return Value(on ? 1.0 : 0.0); };
  if (name == "_x" || name == "_abs_x") return position(0);
  if (name == "_y" || name == "_abs_y") return position(1);
  if (name == "_z" || name == "_abs_z") return position(2);
  if (name == "_line") return block_ + 1.0;
  if (name == "_motion_mode") return 10.0 * f.motion_g;
  if (name == "_plane") return 10.0 * f.plane_g;
  if (name == "_ccomp") return 400.0;
  if (name == "_metric") return flag(!s.inch);
  if (name == "_imperial") return flag(s.inch);
  if (name == "_absolute") return flag(!s.incremental);
  if (name == "_incremental") return flag(s.incremental);
  if (name == "_inverse_time") return flag(s.feed_mode == FeedMode::inverse_time);
  if (name == "_units_per_minute") return flag(s.feed_mode == FeedMode::per_minute);
  if (name == "_units_per_rev") return flag(s.feed_mode == FeedMode::per_revolution);
  if (name == "_coord_system") return s.work_offset > 590 ? s.work_offset : 10.0 * s.work_offset;
  if (name == "_retract_r_plane") return flag(f.return_to_r);
  if (name == "_retract_old_z") return flag(!f.return_to_r);
  if (name == "_ijk_absolute_mode") return flag(s.absolute_arc_centre);
  if (name == "_lathe_diameter_mode") return 0.0;
  if (name == "_lathe_radius_mode") return 1.0;
  if (name == "_spindle_on") return flag(s.spindle != SpindleDirection::stopped);
  if (name == "_spindle_cw") return flag(s.spindle == SpindleDirection::clockwise);
  if (name == "_spindle_rpm_mode") return 1.0;
  if (name == "_spindle_css_mode") return 0.0;
  if (name == "_flood") return flag(s.coolant);
  if (name == "_mist") return 0.0;
  if (name == "_speed_override" || name == "_feed_override") return 1.0;
  if (name == "_adaptive_feed" || name == "_feed_hold" || name == "_tool_offset") return 0.0;
  if (name == "_feed") return f.feed;
  if (name == "_rpm") return s.spindle_speed_rpm;
  if (name == "_current_tool") return static_cast<double>(s.tool);
  if (name == "_selected_tool") return static_cast<double>(f.selected_tool);
  if (name == "_vmajor") return 2.9;
  if (name == "_vminor" || name == "_task" || name == "_remap_level") return 0.0;
  if (name == "_call_level") return call_level_;
  if (name == "_value") return result_.value_or(0);
  if (name == "_value_returned") return flag(result_.has_value());
  return std::nullopt;
}

/// The comment behind #3000 or #3006.
std::string SystemVariables::message_of_block() const {
  const Block& b = program_->blocks[block_];
  const auto text = std::string_view(program_->source.text()).substr(b.offset, b.length);
  const std::size_t open = text.find('('), close = text.rfind(')');
  if (open == std::string_view::npos || close == std::string_view::npos || close < open) return {};
  return std::string(text.substr(open, close + 1 - open));
}

void SystemVariables::set(int number, Value value, std::size_t offset) {
  if (set_offset(number, value, offset)) return;
  if (!dialect_.system_4000)
    throw MacroError(offset, "variable", fmt::format("#{} cannot be set by a program", number));
  if (number == 3000)
    throw MacroError(offset, "alarm",
                     fmt::format("the program stops here with alarm {} {}; the rest is not read",
                                 3000 + value.value_or(0), message_of_block()));
  if (number == 3001) {
    clock_3001_ = clock_s() - value.value_or(0) / 1000;
  } else if (number == 3002) {
    clock_3002_ = clock_s() - value.value_or(0) * 3600;
  } else if (number == 3006) {
    if (!out_.moves.empty()) out_.moves.back().exact_stop = true;
  } else if (within(number, 2000, 2999) || within(number, 5201, 5400) || within(number, 7001, 7960) ||
             within(number, 10001, 19999)) {
    report_.warning(offset, "variable",
                    fmt::format("#{} (an offset that Camber does not know) is set by the program; it is assumed not to "
                                "affect the path",
                                number),
                    "offset set");
  } else if (!within(number, 1000, 1199) && !within(number, 3003, 3012) && !within(number, 3901, 3902)) {
    throw MacroError(offset, "variable",
                     fmt::format("#{} cannot be set on a {} control that Camber knows", number, dialect_.name));
  }
}

}  // namespace camber::nc
