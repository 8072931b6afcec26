#include "repath/resegment.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "nc/replace_blocks.h"
#include "repath/run_text.h"
#include "repath/smoothed_path.h"

namespace camber::repath {

struct Resegmenter::Prepared {
  Run run;
  SpacePath path;
  SmoothedPath smoothed;
};

Resegmenter::Resegmenter(const nc::Program& program, const nc::Interpretation& moves, const ResegmentOptions& options)
    : program_(program), moves_(moves), style_(text_style_of(program, moves, options.whole_numbers_are_increments)) {
  for (const Run& run : find_runs(program, moves, true)) {
    SpacePath path = space_path_of(moves, run);
    if (path.points.size() < 3) continue;
    const bool inch = moves.state_of(moves.moves[run.first_move]).inch;
    const double increment = (inch ? kMmPerInch : 1) * std::pow(10.0, -style_.decimals);
    SmoothedPath smoothed(path.points, options, increment);
    runs_.push_back({run, std::move(path), std::move(smoothed)});
  }
}

Resegmenter::~Resegmenter() = default;

Resegmentation Resegmenter::lay_out(const ResegmentOptions& options) const {
  Resegmentation out;
  std::vector<nc::BlockReplacement> replacements;
  for (const auto& [run, path, smoothed] : runs_) {
    const nc::Move& first = moves_.moves[run.first_move];
    const Layout layout = smoothed.lay_out(length_for(path, first.feed_mm_per_s, options));
    if (layout.points == path.points) continue;
    replacements.push_back({first.block, moves_.moves[run.last_move].block,
                            text_of(program_, moves_, run, path, layout, style_, options.feed_factor)});
    out.runs.push_back(
        {replacements.back().first, replacements.back().last, layout.points.size() - 1, 0, layout.deviation_mm});
    out.max_deviation_mm = std::max(out.max_deviation_mm, layout.deviation_mm);
    out.corners += layout.corners;
  }
  place_after(out.runs, replacements);
  out.text = nc::replace_blocks(program_, replacements);
  return out;
}

Resegmentation resegment(const nc::Program& program, const nc::Interpretation& moves, const ResegmentOptions& options) {
  return Resegmenter(program, moves, options).lay_out(options);
}

}  // namespace camber::repath
