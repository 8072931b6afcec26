#include "feedmodel/motion_times.h"

#include <cassert>

#include "feedmodel/axis_places.h"
#include "feedmodel/plan.h"
#include "feedmodel/rapid.h"
#include "kinematics/joint_map.h"

namespace camber::feedmodel {
namespace {

void add_plan(const MotionPlan& plan, MotionTimes& out) {
  assert(plan.times.size() == plan.rows.size());
  double end_s = 0;
  for (std::size_t i = 0; i < plan.times.size(); ++i) {
    const SegmentTime& time = plan.times[i];
    out.move_s[time.move] += time.end_s() - end_s;
    end_s = time.end_s();
    if (time.cutting && !time.rest)
      out.acceleration[time.move] = static_cast<float>(plan.rows[i].acceleration_mm_per_s2);
  }
  out.speed_changes = plan.speed_changes;
}

void count_positionings(const nc::Interpretation& program, const machine::Machine& machine, MotionTimes& out) {
  const Vec3 speed = rapid_speeds_mm_per_s(machine), acceleration = rapid_accelerations_mm_per_s2(machine);
  AxisPlaces places(machine, kinematics::has_rotary_motion(program, machine));
  for (const nc::Move& move : program.moves) {
    const AxisPlaces::Way way = places.pass(move);
    out.unplaced_moves += !way.complete;
    const Vec3 distance = way.to_mm - way.from_mm;
    if (move.kind == nc::MoveKind::rapid && !distance.isZero(0))
      out.below_full_rapid += below_full_rapid(distance, speed, acceleration);
  }
}

}  // namespace

MotionTimes motion_times(const nc::Interpretation& program, const machine::Machine& machine) {
  MotionTimes out;
  out.move_s.assign(program.moves.size(), 0.0);
  out.acceleration.assign(program.moves.size(), 0.0F);
  add_plan(plan_motion(program, machine), out);
  count_positionings(program, machine, out);
  return out;
}

}  // namespace camber::feedmodel
