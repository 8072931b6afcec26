#include "feedmodel/turning_corner.h"

#include <algorithm>

namespace camber::feedmodel {
namespace {

constexpr double kSameDirection = 1e-9;
/// Steps below this, in mm or rad per unit of path, are rounding of numbers.
constexpr double kNoStep = 1e-7;

}  // namespace

double corner_trim(const Segment& from, const Segment& to, const CornerRoom& room) {
  const double change = (to.direction_at(0) - from.direction_at(from.length_mm)).norm();
  return change > kSameDirection ? std::min(room.room, 4 * room.tolerance_mm / change) : room.room;
}

Segment rounded_corner(const Segment& from, double from_end_s, const Segment& to, double trim) {
  Segment corner = part_of(from, from_end_s, from_end_s + 2 * trim);
  Turn turn = *corner.turn;
  turn.bend = (to.turn->rate - from.turn->rate) / (4 * trim);
  turn.bend_mm = (to.along - from.along) / (4 * trim);
  corner.turn = std::make_shared<const Turn>(turn);
  corner.move = to.move;
  corner.cutting = from.cutting || to.cutting;
  corner.feed_command_mm_per_s = std::max(from.feed_command_mm_per_s, to.feed_command_mm_per_s);
  corner.speed_limit_mm_per_s = std::max(from.speed_limit_mm_per_s, to.speed_limit_mm_per_s);
  corner.acceleration_mm_per_s2 = std::min(from.acceleration_mm_per_s2, to.acceleration_mm_per_s2);
  corner.entry_limit_mm_per_s = machine::kNoLimit;
  return corner;
}

double joint_step_speed(const AxisValues& from, const AxisValues& to, const AxisValues& permitted) {
  AxisValues step{to.linear - from.linear, to.rotary - from.rotary};
  for (int i = 0; i < 3; ++i) {
    if (std::abs(step.linear[i]) < kNoStep) step.linear[i] = 0;
    if (std::abs(step.rotary[i]) < kNoStep) step.rotary[i] = 0;
  }
  return limit_along_joints(step, permitted);
}

}  // namespace camber::feedmodel
