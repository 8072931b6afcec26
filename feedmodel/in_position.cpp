#include "feedmodel/in_position.h"

#include <algorithm>
#include <cmath>

#include "feedmodel/axes.h"

namespace camber::feedmodel {
namespace {

constexpr double kShortestPeriodS = 1e-4;  // of this simulation alone

}  // namespace

double in_position_wait_s(const machine::Machine& machine, const Segment& segment, const SegmentMotion& motion) {
  const double width_mm = machine.control.in_position_mm;
  if (std::isinf(width_mm)) return 0;
  machine::Machine m = machine;
  m.control.period_s = std::max(machine.control.period_s, kShortestPeriodS);
  const double period_s = m.control.period_s, end_s = motion.duration_s;
  const double max_s = settling_time_s(m);
  if (max_s == 0) return 0;
  const double from_s = std::max(0.0, end_s - max_s);
  Axes axes(m, motion.point_at(segment, from_s));
  const auto steps = static_cast<long>(std::ceil((end_s - from_s) / period_s));
  for (long k = steps - 1; k > 0; --k) axes(motion.point_at(segment, end_s - static_cast<double>(k) * period_s));
  const Vec3 end_mm = motion.point_at(segment, end_s);
  Vec3 at_mm = axes(end_mm);
  double wait_s = 0;
  while ((at_mm - end_mm).cwiseAbs().maxCoeff() > width_mm && wait_s < max_s) {
    at_mm = axes(end_mm);
    wait_s += period_s;
  }
  return wait_s;
}

}  // namespace camber::feedmodel
