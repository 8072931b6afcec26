#include "feedmodel/rests.h"

#include <algorithm>
#include <cmath>

namespace camber::feedmodel {

using nc::EventKind;

std::vector<std::uint32_t> rests_of(const nc::Interpretation& program, const machine::Cycle& cycle) {
  std::vector<std::uint32_t> rests;
  for (const nc::Event& event : program.events) {
    const bool quick = (event.kind == EventKind::tool_select && cycle.t_code_s == 0) ||
                       (event.kind == EventKind::spindle_speed && cycle.s_code_s == 0) ||
                       (event.kind == EventKind::m_code && cycle.m_code_s == 0);
    if (!quick && (rests.empty() || rests.back() != event.before_move)) rests.push_back(event.before_move);
  }
  return rests;
}

double spindle_start_s(const machine::Spindle& spindle, double speed_rpm) {
  if (spindle.start_time_s > 0) return spindle.start_time_s * std::max(0.0, speed_rpm) / spindle.max_rpm;
  const double n = speed_rpm, n1 = spindle.constant_torque_rpm, n2 = spindle.constant_power_rpm;
  if (spindle.gd2_kgf_m2 <= 0 || n <= 0 || std::isinf(spindle.power_W) || std::isinf(n1)) return 0;
  const double flywheel = 1.03 * spindle.gd2_kgf_m2 / spindle.power_W;
  double t = flywheel * std::min(n, n1) * n1 / 375.0;
  if (n > n1) t += flywheel * (std::pow(std::min(n, n2), 2) - n1 * n1) / 750.0;
  if (n > n2) t += flywheel * (n * n * n - n2 * n2 * n2) / (1125.0 * n2);
  return t;
}

double spindle_change_s(const machine::Spindle& spindle, double from_rpm, double to_rpm) {
  return std::abs(spindle_start_s(spindle, to_rpm) - spindle_start_s(spindle, from_rpm));
}

}  // namespace camber::feedmodel
