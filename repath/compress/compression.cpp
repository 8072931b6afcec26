#include "repath/compress/compression.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "base/units.h"
#include "repath/compress/block_joints.h"
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
  constexpr double kMax = 1e4;
  return std::min(kMax, (1 / feeds.line_mm_per_s - 1 / feeds.arc_mm_per_s) / std::max(feeds.block_s, 1e-9));
}

/// Rewrites the runs of a program, one chain of runs after the other.
class Compressor {
 public:
  Compressor(const nc::Program& program, const nc::Interpretation& moves, const CompressOptions& options)
      : program_(program), moves_(moves), options_(options), style_(text_style_of(program, moves)) {}

  void rewrite(const RunChain& runs) {
    if (runs.path.points.size() < 2) return;
    const FitOptions options = fit_options(runs.parts.front().run);
    std::vector<std::uint32_t> ends = runs.ends;
    // A run that does not become shorter stays as it is, and so must what its neighbours were joined to.
    for (bool again = true; again;) {
      const Polyline polyline{runs.path.points, runs.path.heights, ends, runs.arc_before, runs.arc_behind};
      const std::vector<Primitive> chain = fit(polyline, options, &memory_);
      std::vector<Rewrite> rewrites;
      again = false;
      for (const RunChain::Part& part : runs.parts) {
        if (part.last_point == part.first_point) continue;
        Rewrite now = rewritten(runs, part, chain);
        // The G1 behind an arc costs no block where a further run follows: see join_modes.
        const bool more = part.last_point < runs.parts.back().last_point;
        const std::size_t lines = now.text.lines.size() + (now.mode_behind.empty() || more ? 0 : 1);
        const bool stays = lines >= now.text.last - now.text.first + 1;
        if (!stays) rewrites.push_back(std::move(now));
        again |= stays && now.primitives.size() < part.last_point - part.first_point && runs.parts.size() > 1 &&
                 keep_blocks(part, ends);
      }
      if (again) continue;
      join_modes(runs, rewrites);
      take(std::move(rewrites), runs, kinks_beside_arcs(polyline, options, chain));
    }
  }

  Compression result() {
    if (joints_ > 0) out_.rms_kink_rad = std::sqrt(kink_squares_ / static_cast<double>(joints_));
    place_after(out_.runs, replacements_);
    if (joints_ > 0) out_.max_kink_block = block_of(worst_kink_);
    if (out_.max_edge_rad > 0) out_.max_edge_block = block_of(worst_edge_);
    out_.text = style_.rules->renumbered(nc::replace_blocks(program_, replacements_));
    return std::move(out_);
  }

 private:
  static constexpr std::size_t kNoRewrite = static_cast<std::size_t>(-1);
  struct KinkPlace {
    std::size_t rewrite = kNoRewrite, line = 0;  ///< line of the text of a replacement, or
    std::uint32_t block = 0;                     ///< a block of the given program
  };
  struct Rewrite {
    const RunChain::Part* part = nullptr;
    std::vector<Primitive> primitives;
    nc::BlockReplacement text;
    std::vector<std::size_t> line_of;  ///< by primitive
    std::string mode_behind;
  };

  FitOptions fit_options(const BlockRun& run) const {
    FitOptions out = options_.fit;
    out.tolerance_mm = options_.tolerance_mm;
    out.increment_mm =
        (moves_.state_of(moves_.moves[run.first_move]).inch ? kMmPerInch : 1) * std::pow(10.0, -style_.decimals);
    out.helices = options_.helices && style_.rules->motion_is_modal();
    if (options_.feeds) out.primitives_per_line_mm = blocks_per_line_mm(*options_.feeds);
    out.arcs = out.arcs && (run.current_plane || options_.switch_planes);
    return out;
  }

  Rewrite rewritten(const RunChain& runs, const RunChain::Part& part, const std::vector<Primitive>& chain) const {
    const auto from = [](const Primitive& p, std::uint32_t point) { return p.first < point; };
    const auto begin = std::lower_bound(chain.begin(), chain.end(), part.first_point, from);
    Rewrite out{&part, {begin, std::lower_bound(begin, chain.end(), part.last_point, from)}, {}, {}, {}};
    write(runs, out, false);
    return out;
  }

  void write(const RunChain& runs, Rewrite& rewrite, bool says_mode) const {
    const BlockRun& run = rewrite.part->run;
    RunLines lines = text_of(program_, moves_, run, runs.path, rewrite.primitives, style_, says_mode);
    rewrite.text = {moves_.moves[run.first_move].block, moves_.moves[run.last_move].block, std::move(lines.lines)};
    rewrite.line_of = std::move(lines.line_of);
    rewrite.mode_behind = std::move(lines.mode_behind);
  }

  /// Behind a run that ends on an arc the next one says its code itself; where none follows, G1 stands alone.
  void join_modes(const RunChain& runs, std::vector<Rewrite>& rewrites) const {
    for (std::size_t k = 0; k < rewrites.size(); ++k) {
      if (rewrites[k].mode_behind.empty()) continue;
      if (k + 1 < rewrites.size() && rewrites[k + 1].text.first == rewrites[k].text.last + 1)
        write(runs, rewrites[k + 1], true);
      else
        rewrites[k].text.lines.push_back(rewrites[k].mode_behind);
    }
  }

  /// Makes every point of the run an end. False where they all were.
  static bool keep_blocks(const RunChain::Part& part, std::vector<std::uint32_t>& ends) {
    std::vector<std::uint32_t> points(part.last_point - part.first_point - 1), all;
    std::iota(points.begin(), points.end(), part.first_point + 1);
    std::set_union(ends.begin(), ends.end(), points.begin(), points.end(), std::back_inserter(all));
    const bool more = all.size() > ends.size();
    ends = std::move(all);
    return more;
  }

  void take(std::vector<Rewrite> rewrites, const RunChain& runs, const std::vector<Kink>& kinks) {
    if (rewrites.empty()) return;
    const std::size_t first = replacements_.size();
    for (Rewrite& r : rewrites) {
      RewrittenRun run{r.text.first, r.text.last};
      for (const Primitive& p : r.primitives) {
        ++(p.arc ? run.arcs : run.lines);
        run.deviation_mm = std::max(run.deviation_mm, p.deviation_mm);
      }
      out_.max_deviation_mm = std::max(out_.max_deviation_mm, run.deviation_mm);
      out_.runs.push_back(run);
      replacements_.push_back(std::move(r.text));
    }
    for (const Kink& kink : kinks) {
      if (kink.of_path) {
        if (kink.angle_rad > out_.max_edge_rad) {
          out_.max_edge_rad = kink.angle_rad;
          worst_edge_ = place_of(kink, runs, rewrites, first);
        }
        continue;
      }
      if (kink.angle_rad > out_.max_kink_rad) {
        out_.max_kink_rad = kink.angle_rad;
        worst_kink_ = place_of(kink, runs, rewrites, first);
      }
      kink_squares_ += kink.angle_rad * kink.angle_rad;
      ++joints_;
    }
  }

  /// The primitive that begins at the kink: a line of the text of a rewritten run, or a block that stays.
  KinkPlace place_of(const Kink& kink, const RunChain& runs, const std::vector<Rewrite>& rewrites,
                     std::size_t first) const {
    for (std::size_t k = 0; k < rewrites.size(); ++k) {
      const auto& primitives = rewrites[k].primitives;
      const auto at = std::ranges::find(primitives, kink.point, &Primitive::first);
      if (at != primitives.end())
        return {first + k, rewrites[k].line_of[static_cast<std::size_t>(at - primitives.begin())], 0};
    }
    const std::size_t next = std::min<std::size_t>(kink.point + 1, runs.path.block.size() - 1);
    return {kNoRewrite, 0, runs.path.block[next]};
  }

  /// Returns the kink's block in the new text.
  std::uint32_t block_of(const KinkPlace& place) const {
    if (place.rewrite != kNoRewrite)
      return out_.runs[place.rewrite].first_block_after + static_cast<std::uint32_t>(place.line);
    std::int64_t shift = 0;
    for (const nc::BlockReplacement& r : replacements_)
      if (r.last < place.block)
        shift += static_cast<std::int64_t>(r.lines.size()) - (static_cast<std::int64_t>(r.last) - r.first + 1);
    return static_cast<std::uint32_t>(place.block + shift);
  }

  const nc::Program& program_;
  const nc::Interpretation& moves_;
  const CompressOptions& options_;
  const TextStyle style_;
  FitMemory memory_;
  Compression out_;
  std::vector<nc::BlockReplacement> replacements_;
  KinkPlace worst_kink_, worst_edge_;
  double kink_squares_ = 0;
  std::size_t joints_ = 0;
};

}  // namespace

Compression compress(const nc::Program& program, const nc::Interpretation& moves, const CompressOptions& options) {
  Compressor compressor(program, moves, options);
  const std::vector<BlockRun> runs = runs_to_compress(program, moves, options.switch_planes && options.fit.arcs);
  for_each_chain(moves, runs, [&](const RunChain& chain) {
    compressor.rewrite(chain);
    if (options.progress && !chain.parts.empty())
      options.progress(chain.parts.back().run.last_move / static_cast<double>(moves.moves.size()));
  });
  return compressor.result();
}

}  // namespace camber::repath
