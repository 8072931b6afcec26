// Centre drilling, pecks, reaming.
#include <algorithm>

#include "copymill/operation.h"

namespace camber::copymill {
namespace {

constexpr double kClearance_mm = 1;      ///< above material; feed begins here
constexpr double kBackToDepth_mm = 0.5;  ///< a peck begins so far above the last one's bottom

Runner::Ended drill(const OperationCut& cut, const Standing& standing, Runner& runner, const Vec2& at) {
  const machine::CopyOperation& o = cut.operation;
  const auto [bottom, top] = *o.region.z_mm;
  const double begin = std::max({top, standing.highest_under_mm(at, cut.shape.radius_mm),
                                 runner.clear_height().lowest_clear_tip_mm(cut.shape, at)}) +
                       kClearance_mm;
  const Vec3 above(at.x(), at.y(), runner.safe_z_mm());
  const auto to = [&](double z) { return Vec3(at.x(), at.y(), z); };
  if (runner.rapid(above) != Runner::Ended::done || runner.rapid(to(begin)) != Runner::Ended::done)
    return runner.ended();
  double depth = top;
  while (depth > bottom) {
    depth = o.cycle == machine::HoleCycle::peck ? std::max(bottom, depth - o.axial_depth_mm) : bottom;
    if (runner.cut({to(depth)}, false) != Runner::Ended::done) break;
    if (depth <= bottom) break;
    if (runner.rapid(to(begin)) != Runner::Ended::done) break;
    const double down = depth + kBackToDepth_mm;
    if (down < begin && runner.rapid(to(down)) != Runner::Ended::done) break;
  }
  if (o.cycle == machine::HoleCycle::ream && !runner.stopped()) runner.cut({to(begin)}, false);
  return runner.rapid(above);
}

}  // namespace

void drill_holes(const OperationCut& cut, Standing& standing, Runner& runner, double safe_z_mm) {
  runner.begin(cut, standing, safe_z_mm, nullptr, (*cut.operation.region.z_mm)[0]);
  const machine::CopyOperation& o = cut.operation;
  std::vector<Vec2> holes = o.holes_mm;
  if (holes.empty()) holes.push_back(0.5 * ((*o.region.box_mm)[0] + (*o.region.box_mm)[1]));
  for (const Vec2& hole : holes) {
    ++runner.summary().passes;
    if (drill(cut, standing, runner, hole) != Runner::Ended::done) return;
  }
}

}  // namespace camber::copymill
