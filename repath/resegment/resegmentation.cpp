#include "repath/resegment/resegmentation.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/units.h"
#include "nc/emit.h"
#include "repath/resegment/smoothed_path.h"
#include "repath/run_text.h"

namespace camber::repath {

namespace {

constexpr double kSagittaFraction = 0.02;  ///< of the tolerance: lines that stand for arcs

}  // namespace

/// A stretch of a run between arcs that stay.
struct Resegmenter::Prepared {
  SpacePath path;
  std::optional<SmoothedPath> smoothed;  ///< none: too few points
};

Resegmenter::Resegmenter(const nc::Program& program, const nc::Interpretation& moves, const ResegmentOptions& options)
    : program_(program),
      moves_(moves),
      options_(options),
      style_(text_style_of(program, moves)),
      runs_(find_runs(program, moves, RunKind::with_arcs)) {}

Resegmenter::~Resegmenter() = default;

const Resegmenter::Prepared& Resegmenter::prepared(const BlockRun& stretch) {
  const auto [at, is_new] = prepared_.try_emplace({stretch.first_move, stretch.last_move});
  Prepared& out = at->second;
  if (!is_new) return out;
  out.path = space_path_of(moves_, stretch, kSagittaFraction * options_.tolerance_mm);
  if (out.path.points.size() < 3) return out;
  const bool inch = moves_.state_of(moves_.moves[stretch.first_move]).inch;
  ResegmentOptions options = options_;
  options.tolerance_mm -= out.path.sagitta_mm;
  out.smoothed.emplace(out.path.points, options, (inch ? kMmPerInch : 1) * std::pow(10.0, -style_.decimals));
  return out;
}

/// One way of laying the program out.
class Resegmenter::Writer {
 public:
  Writer(Resegmenter& resegmenter, const ResegmentOptions& options) : of_(resegmenter), options_(options) {}

  void add(const BlockRun& run) {
    const double length = length_for(of_.moves_, run, options_);
    for (const BlockRun& stretch : between_arcs(of_.program_, of_.moves_, run, {length, of_.options_.tolerance_mm}))
      add(stretch, length);
  }

  Resegmentation result() {
    place_after(out_.runs, replacements_);
    out_.text = of_.style_.rules->renumbered(nc::replace_blocks(of_.program_, replacements_));
    return std::move(out_);
  }

 private:
  void add(const BlockRun& stretch, double length_mm) {
    const Prepared& now = of_.prepared(stretch);
    if (!now.smoothed) return;
    const Layout layout = now.smoothed->lay_out(length_mm, options_.corners.any());
    const bool arcs = now.path.sagitta_mm > 0;
    if (arcs && layout.points.size() - 1 >= stretch.last_move - stretch.first_move + 1) {
      for (const BlockRun& lines : between_arcs(of_.program_, of_.moves_, stretch, {})) add(lines, length_mm);
      return;
    }
    if (layout.points == now.path.points) return;
    const std::uint32_t first = of_.moves_.moves[stretch.first_move].block;
    const std::uint32_t last = of_.moves_.moves[stretch.last_move].block;
    const double deviation = layout.deviation_mm + now.path.sagitta_mm;
    replacements_.push_back({first, last,
                             text_of(of_.program_, of_.moves_, stretch, now.path, layout, of_.style_,
                                     {options_.feed_factor, options_.corners})});
    out_.runs.push_back({first, last, layout.points.size() - 1, 0, deviation});
    out_.max_deviation_mm = std::max(out_.max_deviation_mm, deviation);
    out_.corners += layout.corners;
  }

  Resegmenter& of_;
  const ResegmentOptions& options_;
  Resegmentation out_;
  std::vector<nc::BlockReplacement> replacements_;
};

Resegmentation Resegmenter::lay_out(const ResegmentOptions& options) {
  Writer writer(*this, options);
  for (const BlockRun& run : runs_) writer.add(run);
  return writer.result();
}

Resegmentation resegment(const nc::Program& program, const nc::Interpretation& moves, const ResegmentOptions& options) {
  return Resegmenter(program, moves, options).lay_out(options);
}

}  // namespace camber::repath
