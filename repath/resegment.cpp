#include "repath/resegment.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "nc/replace_blocks.h"
#include "repath/run_text.h"

namespace camber::repath {

Resegmentation resegment(const nc::Program& program, const nc::Interpretation& moves, const ResegmentOptions& options) {
  const TextStyle style = text_style_of(program, moves, options.whole_numbers_are_increments);
  Resegmentation out;
  std::vector<nc::BlockReplacement> replacements;
  for (const Run& run : find_runs(program, moves, true)) {
    const SpacePath path = space_path_of(moves, run);
    if (path.points.size() < 3) continue;
    const nc::Move& first = moves.moves[run.first_move];
    const double increment = (moves.state_of(first).inch ? kMmPerInch : 1) * std::pow(10.0, -style.decimals);
    const Layout layout = lay_out(path.points, options, length_for(path, first.feed_mm_per_s, options), increment);
    if (layout.points == path.points) continue;
    replacements.push_back({first.block, moves.moves[run.last_move].block,
                            text_of(program, moves, run, path, layout, style, options.feed_factor)});
    out.runs.push_back(
        {replacements.back().first, replacements.back().last, layout.points.size() - 1, 0, layout.deviation_mm});
    out.max_deviation_mm = std::max(out.max_deviation_mm, layout.deviation_mm);
    out.corners += layout.corners;
  }
  place_after(out.runs, replacements);
  out.text = nc::replace_blocks(program, replacements);
  return out;
}

}  // namespace camber::repath
