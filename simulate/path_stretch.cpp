#include "simulate/path_stretch.h"

#include <algorithm>

namespace camber::simulate {

std::vector<ListRange> PathStretch::kept_in(std::size_t from, std::size_t count) const {
  if (!kept) return {{0, count}};
  std::vector<ListRange> out;
  for (const ListRange& range : *kept) {
    const std::size_t begin = std::max(range.from, from - first), end = std::min(range.end, from - first + count);
    if (begin < end) out.push_back({begin + first - from, end + first - from});
  }
  return out;
}

std::vector<PathPiece> path_pieces(const PathStretch& path) {
  std::vector<PathPiece> out;
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

}  // namespace camber::simulate
