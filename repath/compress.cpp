#include "repath/compress.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "repath/joints.h"
#include "repath/run_text.h"

namespace camber::repath {

void place_after(std::vector<RewrittenRun>& runs, const std::vector<nc::BlockReplacement>& replacements) {
  std::int64_t shift = 0;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const nc::BlockReplacement& r = replacements[k];
    const auto lines = static_cast<std::int64_t>(r.lines.size());
    runs[k].first_block_after = static_cast<std::uint32_t>(r.first + shift);
    runs[k].last_block_after = static_cast<std::uint32_t>(r.first + shift + lines - 1);
    shift += lines - (static_cast<std::int64_t>(r.last) - r.first + 1);
  }
}

double cutting_time_s(const nc::Interpretation& moves, const FeedsByKind& feeds) {
  double time_s = 0;
  for (const nc::Move& move : moves.moves) {
    const bool arc = move.kind == nc::MoveKind::arc;
    if (!arc && move.kind != nc::MoveKind::linear) continue;
    time_s += nc::length_mm(moves, move) / (arc ? feeds.arc_mm_per_s : feeds.line_mm_per_s) + feeds.block_s;
  }
  return time_s;
}

namespace {

/// How many blocks more may be had for a millimetre of lines that becomes one of arcs.
double blocks_per_line_mm(const FeedsByKind& feeds) {
  constexpr double kMost = 1e4;
  return std::min(kMost, (1 / feeds.line_mm_per_s - 1 / feeds.arc_mm_per_s) / std::max(feeds.block_s, 1e-9));
}

}  // namespace

Compression compress(const nc::Program& program, const nc::Interpretation& moves, const CompressOptions& options) {
  const TextStyle style = text_style_of(program, moves, options.whole_numbers_are_increments);
  Compression out;
  std::vector<nc::BlockReplacement> replacements;
  double kink_squares = 0;
  std::size_t joints = 0;
  for (const Run& run : runs_to_compress(program, moves, options.switch_planes && options.fit.arcs)) {
    const RunPath path = path_of(moves, run);
    if (path.points.size() < 2) continue;
    const nc::Move& first = moves.moves[run.first_move];
    FitOptions fit_options = options.fit;
    fit_options.tolerance_mm = options.tolerance_mm;
    fit_options.increment_mm = (moves.state_of(first).inch ? kMmPerInch : 1) * std::pow(10.0, -style.decimals);
    fit_options.helices = options.helices;
    if (options.feeds) fit_options.primitives_per_line_mm = blocks_per_line_mm(*options.feeds);
    fit_options.arcs = fit_options.arcs && (run.current_plane || options.switch_planes);
    const Polyline polyline{path.points, path.heights};
    const std::vector<Primitive> chain = fit(polyline, fit_options);
    nc::BlockReplacement replacement{first.block, moves.moves[run.last_move].block,
                                     text_of(program, moves, run, path, chain, style)};
    if (replacement.lines.size() >= replacement.last - replacement.first + 1) continue;
    RewrittenRun rewritten{replacement.first, replacement.last};
    for (const Primitive& p : chain) {
      ++(p.arc ? rewritten.arcs : rewritten.lines);
      rewritten.deviation_mm = std::max(rewritten.deviation_mm, p.deviation_mm);
    }
    out.max_deviation_mm = std::max(out.max_deviation_mm, rewritten.deviation_mm);
    for (const double kink : smooth_kinks_of(polyline, fit_options, chain)) {
      out.max_kink_rad = std::max(out.max_kink_rad, kink);
      kink_squares += kink * kink;
      ++joints;
    }
    out.runs.push_back(rewritten);
    replacements.push_back(std::move(replacement));
  }
  if (joints > 0) out.rms_kink_rad = std::sqrt(kink_squares / static_cast<double>(joints));
  place_after(out.runs, replacements);
  out.text = nc::replace_blocks(program, replacements);
  return out;
}

}  // namespace camber::repath
