#include "compensate/least_feed.h"

#include <algorithm>
#include <limits>

#include "feedmodel/motion_plan.h"

namespace camber::compensate {
namespace {

constexpr double kNear_mm = 2.0;           // of path: as far as the motion through a corner reaches
constexpr double kLowest = 0.5;            // of the least fraction elsewhere
constexpr double kStopped_mm_per_s = 0.1;  // slower is a stop
constexpr double kNone = std::numeric_limits<double>::infinity();

/// Speed at which the control passes from the move that ends at each point to the next one; infinite elsewhere.
std::vector<double> corner_speeds(const ShiftPath& path, const nc::Interpretation& program,
                                  const machine::Machine& machine) {
  std::vector<double> out(path.points().size(), kNone);
  const feedmodel::MotionPlan plan = feedmodel::plan_motion(program, machine);
  for (std::size_t i = 1; i < plan.rows.size(); ++i) {
    const feedmodel::SegmentTime &before = plan.times[i - 1], &now = plan.times[i];
    if (!before.cutting || !now.cutting || before.rest || now.rest || before.move == now.move) continue;
    const double speed = plan.rows[i].entry_speed_mm_per_s;
    if (speed < kStopped_mm_per_s || !path.contains(before.move)) continue;
    double& at_end = out[path.find(before.move, 1.0).lower + 1];
    at_end = std::min(at_end, speed);
  }
  return out;
}

/// Along a chain, each value becomes the lowest one within kNear_mm.
void spread(const ShiftPath& path, const Chain& chain, std::vector<double>& speeds) {
  const auto& points = path.points();
  const std::vector<double> from(speeds.begin() + static_cast<std::ptrdiff_t>(chain.from),
                                 speeds.begin() + static_cast<std::ptrdiff_t>(chain.from + chain.count));
  for (std::size_t c = 0; c < chain.count; ++c) {
    if (from[c] == kNone) continue;
    const double at = points[chain.from + c].along_mm;
    const auto lower = [&](std::size_t i) { speeds[i] = std::min(speeds[i], from[c]); };
    for (std::size_t i = chain.from + c; i > chain.from && at - points[i].along_mm < kNear_mm; --i) lower(i);
    // A piece behind the corner begins at the point before the one that it ends at.
    for (std::size_t i = chain.from + c + 1; i < chain.from + chain.count && points[i - 1].along_mm - at < kNear_mm;
         ++i)
      lower(i);
  }
}

}  // namespace

std::vector<double> least_feeds(const ShiftPath& path, const nc::Interpretation& program,
                                const machine::Machine& machine, double least) {
  std::vector<double> out = corner_speeds(path, program, machine);
  for (const Chain& chain : path.chains()) spread(path, chain, out);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double feed = program.moves[path.points()[i].move].feed_mm_per_s;
    out[i] = feed > 0 ? std::clamp(out[i] / feed, kLowest * least, least) : least;
  }
  return out;
}

}  // namespace camber::compensate
