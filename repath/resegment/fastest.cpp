#include "repath/resegment/fastest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <span>

#include "kinematics/machine_program.h"
#include "nc/language.h"
#include "repath/resegment/smoothed_path.h"

namespace camber::repath {
namespace {

constexpr double kLengths[] = {10, 6.3, 4, 3.2, 2.5, 2, 1.6, 1.25, 1};  ///< longest first: they are rarely slower
constexpr int kNoBetter = 2;                                            ///< lengths in a row that are no faster: enough
constexpr double kMinGain = 1.002;                                      ///< less is not worth another program
constexpr double kSameTime = 1.001;  ///< what is no faster than this has no say: the path with the smaller error has
constexpr double kAlmostSameTime = 1.005;  ///< is worth fewer blocks

constexpr double kPredictedBlocks = 3e6;  ///< by all trials of feeds together
constexpr double kFewestTrials = 12, kMaxTrials = 70;
constexpr double kFirstFeed = 0.7, kMinFeed = 0.25, kMinFraction = 0.1;
constexpr double kAim = 0.998;    ///< of the limit
constexpr double kNearer = 0.99;  ///< than the old program, by so much: worth another one where none keeps to the limit

bool better(const ContourFigures& a, const ContourFigures& b) {
  if (a.time_s * kSameTime < b.time_s || b.time_s * kSameTime < a.time_s) return a.time_s < b.time_s;
  return a.contour_max_mm < b.contour_max_mm;
}

ContourLimit limit_of(const ContourFigures& before, const FastestOptions& options) {
  if (options.contour_mm > 0) return {options.contour_mm, std::numeric_limits<double>::infinity()};
  const double tolerance = options.layout.tolerance_mm;
  return {std::max(before.contour_max_mm, tolerance), std::max(before.contour_rms_mm, tolerance)};
}

/// How long the slowest axis is behind the command: half of a moving average, and the position loop.
double lag_s(const machine::Machine& machine) {
  double lag = 0;
  for (const machine::Axis& axis : machine.axis)
    lag =
        std::max(lag, 0.5 * axis.filter_s + axis.exponential_1_s + axis.exponential_2_s + 1 / axis.position_gain_per_s);
  return lag;
}

class Search {
 public:
  Search(const nc::Program& program, const nc::Interpretation& moves, const machine::Machine& machine,
         const ContourFigures& before, const FastestOptions& options)
      : name_(program.source.name()),
        language_(program.language),
        machine_(machine),
        options_(options),
        resegmenter_(program, moves, options.layout),
        meant_(moves),
        before_(before) {
    out_.limit = limit_of(before, options);
    out_.within_limit = false;
  }

  Fastest run(const nc::Program& program, const nc::Interpretation& moves) {
    if (nothing_to_gain(moves)) {
      out_.gains = false;
      out_.within_limit = true;
      out_.path.text = program.source.text();
      return std::move(out_);
    }
    const std::size_t best = best_length();
    out_.unbounded = best;
    const bool may_gain = out_.tried[best].figures.time_s * kMinGain < before_.time_s;
    if (!out_.limit.holds(out_.tried[best].figures) && (may_gain || !options_.keep_old)) look_for_feeds(best);
    const bool asked_for = options_.layout.length_mm > 0 || !options_.keep_old;
    const bool old_keeps = out_.limit.holds(before_);
    const Candidate& chosen = out_.tried[out_.chosen];
    if (out_.within_limit)
      out_.gains = asked_for || !old_keeps || chosen.figures.time_s * kMinGain < before_.time_s;
    else  // the old program may be the nearest that there is
      out_.gains = asked_for || out_.limit.fraction(chosen.figures) < kNearer * out_.limit.fraction(before_);
    if (out_.gains) {
      out_.path = resegmenter_.lay_out(layout_of(chosen));
    } else {
      out_.path.text = program.source.text();
      out_.within_limit = old_keeps;
    }
    return std::move(out_);
  }

 private:
  /// True where laying out again cannot pay: no new block is faster than its length over the feed.
  bool nothing_to_gain(const nc::Interpretation& moves) {
    if (options_.layout.length_mm > 0 || !options_.keep_old || !out_.limit.holds(before_) ||
        before_.move_s.size() != moves.moves.size())
      return false;
    double max_s = 0;
    for (const double length : {kLengths[0], 1.0}) {
      const std::vector<RewrittenRun> runs = resegmenter_.lay_out(layout_of({.length_factor = length})).runs;
      double gain_s = 0;
      auto run = runs.begin();
      for (std::size_t m = 0; m < moves.moves.size(); ++m) {
        const nc::Move& move = moves.moves[m];
        while (run != runs.end() && run->last_block < move.block) ++run;
        if (run == runs.end()) break;
        if (move.editable && move.feed_mm_per_s > 0 && move.block >= run->first_block)
          gain_s += std::max(0.0, before_.move_s[m] - nc::length_mm(moves, move) / move.feed_mm_per_s);
      }
      max_s = std::max(max_s, gain_s);
    }
    return before_.time_s < kMinGain * (before_.time_s - max_s);
  }

  ResegmentOptions layout_of(const Candidate& c) const {
    ResegmentOptions out = options_.layout;
    out.block_time_s = machine_.control.block_time_s;
    out.length_factor = c.length_factor;
    out.feed_factor = c.feed_factor;
    out.corners = c.corners;
    return out;
  }

  /// Its number among those tried.
  std::size_t predict(Candidate c) {
    const std::string text = resegmenter_.lay_out(layout_of(c)).text;
    Diagnostics diagnostics;  // what it says of the text was said of the old one; an error is ours
    const kinematics::MachineProgram program = kinematics::open_program(
        SourceText(name_, text), machine_,
        {.given = options_.interpreter, .rotary = kinematics::RotaryWords::never, .language = language_}, diagnostics);
    diagnostics.throw_if_errors();
    const nc::Interpretation& moves = program.commanded();
    predicted_blocks_ = static_cast<double>(moves.moves.size());
    c.figures = contour_figures(moves, meant_, machine_);
    out_.tried.push_back(c);
    if (options_.progress) options_.progress(static_cast<double>(out_.tried.size()) / max_trials());
    const std::size_t now = out_.tried.size() - 1;
    const bool keeps = out_.limit.holds(c.figures);
    if (now == 0 || choose(c, keeps)) out_.chosen = now;
    out_.within_limit |= keeps;
    return now;
  }

  /// Whether it is to be taken rather than the one chosen so far.
  bool choose(const Candidate& c, bool keeps) const {
    const Candidate& chosen = out_.tried[out_.chosen];
    if (keeps != out_.within_limit) return keeps;
    return keeps ? beats(c, chosen) : out_.limit.fraction(c.figures) < out_.limit.fraction(chosen.figures);
  }

  bool beats(const Candidate& c, const Candidate& other) const {
    return options_.fewest_blocks ? c.figures.time_s * kAlmostSameTime < other.figures.time_s
                                  : better(c.figures, other.figures);
  }

  double trials_of_feeds() const {
    return std::clamp(kPredictedBlocks / std::max(1.0, predicted_blocks_), kFewestTrials, kMaxTrials);
  }

  /// Returns the largest number of trials that there may be.
  double max_trials() const {
    if (last_trial_ > 0) return static_cast<double>(last_trial_);
    return trials_of_feeds() + (options_.layout.length_mm > 0 ? 1.0 : static_cast<double>(std::size(kLengths)));
  }

  /// At the programmed feed: the fastest one.
  std::size_t best_length() {
    if (options_.layout.length_mm > 0) return predict({});
    std::size_t best = predict({.length_factor = kLengths[0]});
    int no_better = 0;
    for (const double length : std::span(kLengths).subspan(1)) {
      const std::size_t now = predict({.length_factor = length});
      const bool take = beats(out_.tried[now], out_.tried[best]);
      if (take) best = now;
      no_better = take ? 0 : no_better + 1;
      if (no_better >= kNoBetter && !options_.fewest_blocks) break;
    }
    return best;
  }

  /// Times of steps between corners first, three lags of the axes before others, then shares about corners; for each
  /// the highest feed that keeps to the limit. Without a gain from one kind of corner the next is not tried.
  void look_for_feeds(std::size_t at_length) {
    last_trial_ = out_.tried.size() + static_cast<std::size_t>(trials_of_feeds());
    const double lag = lag_s(machine_);
    Candidate best = out_.tried[at_length];
    best.feed_factor = kFirstFeed;
    double best_time = std::numeric_limits<double>::infinity();
    const auto take = [&](const CornerFeeds& corners) {
      Candidate c = best;
      c.corners = corners;
      const std::optional<Candidate> found = highest_feed(c);
      if (!found || !(found->figures.time_s < best_time)) return false;
      best = *found;
      best_time = found->figures.time_s;
      return true;
    };
    // Long segments keep farther from the curve, on the side to which axes that lag cut it off.
    best.corners = {1, 3 * lag};
    std::vector<double> lengths{best.length_factor};
    if (options_.layout.length_mm == 0) lengths.insert(lengths.end(), {4.0, 2.0, 1.0});
    for (const double length : lengths) {
      Candidate c = best;
      c.length_factor = length;
      if (length == best.length_factor && length != lengths.front()) continue;
      if (const auto found = highest_feed(c); found && found->figures.time_s < best_time)
        best = *found, best_time = found->figures.time_s;
    }
    for (const double lags : {0.0, 2.0, 4.5}) take({1, lags * lag});
    for (double fraction = 0.7; fraction > kMinFraction && take({fraction, best.corners.settle_s}); fraction *= 0.7) {
    }
    for (const double finer : {1.2, 1 / 1.2, 1.1, 1 / 1.1})
      if (best.corners.settle_s > 0) take({best.corners.fraction, finer * best.corners.settle_s});
    for (const double finer : {1.15, 1 / 1.15})
      if (best.corners.fraction < 1) take({std::min(1.0, finer * best.corners.fraction), best.corners.settle_s});
  }

  /// With the candidate's corners, from its feed on: how far the axes stray grows with a power of the feed, which two
  /// trials tell. Nothing where no trial keeps to the limit.
  std::optional<Candidate> highest_feed(Candidate c) {
    constexpr int kSteps = 5;
    constexpr double kNear = 0.995, kFirstPower = 1.4;
    std::optional<Candidate> out;
    double power = kFirstPower, feed_before = 0, strays_before = 0;
    for (int step = 0; step < kSteps && out_.tried.size() < last_trial_; ++step) {
      const Candidate now = out_.tried[predict(c)];
      const double strays = out_.limit.fraction(now.figures);
      if (strays <= 1 && (!out || now.figures.time_s < out->figures.time_s)) out = now;
      if (strays <= 1 && (strays > kNear || c.feed_factor == 1)) break;
      if (step > 0 && feed_before != c.feed_factor)
        power = std::clamp(std::log(strays / strays_before) / std::log(c.feed_factor / feed_before), 0.3, 4.0);
      feed_before = c.feed_factor;
      strays_before = strays;
      c.feed_factor = std::clamp(c.feed_factor * std::pow(kAim / std::max(strays, 1e-3), 1 / power), kMinFeed, 1.0);
      if (c.feed_factor == feed_before) break;
    }
    return out;
  }

  std::string name_;
  nc::LanguageId language_;
  const machine::Machine& machine_;
  const FastestOptions& options_;
  Resegmenter resegmenter_;
  const MeantPath meant_;
  const ContourFigures& before_;
  double predicted_blocks_ = 0;  ///< of the last one
  std::size_t last_trial_ = 0;
  Fastest out_;
};

}  // namespace

double ContourLimit::fraction(const ContourFigures& f) const {
  return std::max(f.contour_max_mm / max_mm, f.contour_rms_mm / rms_mm);
}

Fastest find_fastest(const nc::Program& program, const nc::Interpretation& moves, const machine::Machine& machine,
                     const ContourFigures& before, const FastestOptions& options) {
  return Search(program, moves, machine, before, options).run(program, moves);
}

}  // namespace camber::repath
