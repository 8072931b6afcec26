#include "feedmodel/plan.h"

#include <algorithm>
#include <cmath>

#include "feedmodel/path_builder.h"

namespace camber::feedmodel {

namespace {

PlanRow row_of(const Segment& s) {
  return {.length_mm = s.length_mm,
          .speed_limit_mm_per_s = s.speed_limit_mm_per_s,
          .acceleration_mm_per_s2 = s.acceleration_mm_per_s2,
          .planned_fraction = s.planned_fraction,
          .joined = s.joined,
          .entry_speed_mm_per_s = s.entry_limit_mm_per_s};
}

}  // namespace

std::vector<PlanRow> plan_path(const nc::Interpretation& program, const machine::Machine& machine) {
  std::vector<PlanRow> rows;
  build_segments(program, machine, [&](const Segment& s) { rows.push_back(row_of(s)); });
  plan_speeds(rows, static_cast<std::size_t>(std::max(0, machine.control.lookahead_blocks)));
  return rows;
}

Trapezoid profile_of(const std::vector<PlanRow>& rows, std::size_t i) {
  const double exit = i + 1 < rows.size() ? rows[i + 1].entry_speed_mm_per_s : 0.0;
  return make_trapezoid(rows[i].length_mm, rows[i].entry_speed_mm_per_s, exit, rows[i].speed_limit_mm_per_s,
                        rows[i].acceleration_mm_per_s2);
}

double PlanClock::begin(const Trapezoid& profile) {
  const bool from_rest = profile.length > 0 && profile.entry < profile.acceleration * period_s_;
  if (from_rest && now_s_ > 0 && std::isfinite(profile.acceleration))
    now_s_ = std::ceil(now_s_ / period_s_ - 1e-9) * period_s_;
  return now_s_;
}

std::vector<SegmentTime> segment_times(const nc::Interpretation& program, const machine::Machine& machine) {
  std::vector<PlanRow> rows;
  std::vector<SegmentTime> times;
  build_segments(program, machine, [&](const Segment& s) {
    rows.push_back(row_of(s));
    times.push_back({.move = s.move, .rest = s.length_mm == 0, .start_s = 0, .duration_s = s.dwell_s});
  });
  plan_speeds(rows, static_cast<std::size_t>(std::max(0, machine.control.lookahead_blocks)));
  PlanClock clock(machine.control.period_s);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Trapezoid profile = profile_of(rows, i);
    SegmentTime& time = times[i];
    time.start_s = clock.begin(profile);
    if (!time.rest) time.duration_s = profile.duration_s();
    clock.advance(time.duration_s);
  }
  return times;
}

}  // namespace camber::feedmodel
