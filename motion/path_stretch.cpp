#include "motion/path_stretch.h"

#include <algorithm>

namespace camber::motion {

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

std::vector<ListRange> PathStretch::kept_in(std::size_t from, std::size_t count) const {
  if (!kept) return {{0, count}};
  std::vector<ListRange> out;
  for (const ListRange& range : *kept) {
    const std::size_t begin = std::max(range.from, from - first), end = std::min(range.end, from - first + count);
    if (begin < end) out.push_back({begin + first - from, end + first - from});
  }
  return out;
}

std::vector<StretchPiece> path_pieces(const PathStretch& path) {
  std::vector<StretchPiece> out;
  for (std::size_t r = 0; r < path.runs.size(); ++r) {
    const removal::ToolRun& run = path.runs[r];
    const std::size_t count =
        run.kind == removal::RunKind::milling ? (run.count + kPieceStamps - 1) / kPieceStamps : std::size_t{1};
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t from = run.count * i / count;
      out.push_back({r, from, run.count * (i + 1) / count - from});
    }
  }
  return out;
}

}  // namespace camber::motion
