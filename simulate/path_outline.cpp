#include "simulate/path_outline.h"

#include <algorithm>

namespace camber::simulate {

void PathOutline::add(const removal::ToolRun& run, const removal::Stamp& stamp) {
  if (runs.empty() || runs.back().from != run.from) {
    runs.push_back({run.tool, run.from, 0, run.kind});
    of_runs.emplace_back();
  }
  ++runs.back().count;
  Run& now = of_runs.back();
  now.tips.add(stamp.pose.tip_mm);
  now.longest_feed_mm = std::max(now.longest_feed_mm, stamp.feed_per_tooth_mm.norm());
  if (stamps++ % kBlock == 0) blocks.emplace_back();
  blocks.back().add(stamp.pose.tip_mm);
  upright = upright && stamp.pose.upright();
}

}  // namespace camber::simulate
