#include "calib/place_trace.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/cancel.h"

namespace camber::calib {
namespace {

using feedmodel::PathPlace;

constexpr double kNearStartMm = 0.5;  // a start is looked for within this distance of the path
constexpr double kAheadMm = 0.5;      // how far ahead of the axes' way a place is looked for
constexpr double kAheadFactor = 1.3;  // times that way: corners are cut
constexpr double kAheadTime = 1.25;   // times the way at the programmed feed: overrides
constexpr double kDetour = 0.02;      // what a millimetre along the path counts beside one off it
constexpr double kOffRapid = 0.02;    // what a millimetre off the line of a rapid counts, where its axes may go
constexpr std::size_t kMaxWays = 12;
constexpr double kHopelessMm = 5.0;  // a way that costs this much more than the best is given up
constexpr double kSamePlaceMm = 0.02;
constexpr double kStillMm = 2e-3;      // from sample to sample
constexpr double kMaxOffPathMm = 0.5;  // of 19 in 20 samples,
constexpr double kMaxOffPathS = 0.03;  // beside so much of the way that axes lag behind, which cut corners
constexpr double kLostMm = 5.0;        // a start from which a sample is this far off is wrong
constexpr std::size_t kTrialSamples = 400;
constexpr std::size_t kMaxStarts = 4000;
constexpr double kSameExtentMm = 1.0;
constexpr double kMinEndSpeed = 0.1;  // of the mean around a sample: slower, the axes stop there
constexpr double kPassageS = 0.002;   // drives of several axes lag by different times
constexpr double kMaxLagChangeS = 0.015;

bool is_feed(const nc::Move& move) { return move.kind == nc::MoveKind::linear || move.kind == nc::MoveKind::arc; }

bool is_actual(const ServoTrace& trace) { return trace.has_actual == std::array<bool, 3>{true, true, true}; }

const Vec3& position(const ServoTrace& trace, std::size_t k) {
  return is_actual(trace) ? trace.actual_mm[k] : trace.command_mm[k];
}

class Follower {
 public:
  Follower(const ServoTrace& trace, const nc::Interpretation& program, const Vec3& offset_mm)
      : trace_(trace), program_(program), offset_mm_(offset_mm) {
    double from_mm = 0;
    for (const nc::Move& move : program.moves) {
      from_mm_.push_back(from_mm);
      length_mm_.push_back(move.reference ? 0 : nc::length_mm(program, move));
      from_mm += length_mm_.back();
    }
  }

  Vec3 at(std::size_t k) const { return position(trace_, k) + offset_mm_; }

  /// All moves that pass near a point: the nearest place of each.
  std::vector<PathPlace> starts(const Vec3& point_mm) const {
    std::vector<PathPlace> found;
    for (std::uint32_t m = 0; m < program_.moves.size() && found.size() < kMaxStarts; ++m) {
      if (program_.moves[m].reference || program_.moves[m].kind == nc::MoveKind::dwell) continue;
      const PathPlace place = feedmodel::closest_on_move(program_, m, point_mm, 0, 1);
      if (place.distance_mm < kNearStartMm) found.push_back(place);
    }
    return found;
  }

  /// Follows the samples from `first` on; returns the mean cost of a sample, infinite where they lead away. Where
  /// samples are far apart several ways may lead to the next one: the best few are kept until one proves to be right.
  double follow(const PathPlace& start, std::size_t first, std::size_t end, std::vector<PathPlace>* out) const {
    std::vector<Layer> layers;
    Layer layer{{start, start.distance_mm, 0}};
    for (std::size_t k = first; k < end; ++k) {
      if (k > first) layer = next(layer, k);
      if (!out && layer.front().place.distance_mm > kLostMm) return std::numeric_limits<double>::infinity();
      if (out) layers.push_back(layer);
    }
    const double cost = layer.front().cost;
    if (out) {
      std::vector<PathPlace> back;
      std::size_t at = 0;
      for (auto l = layers.rbegin(); l != layers.rend(); ++l) {
        back.push_back((*l)[at].place);
        at = (*l)[at].parent;
      }
      out->insert(out->end(), back.rbegin(), back.rend());
    }
    return cost / static_cast<double>(end - first);
  }

 private:
  /// A way that may have led to a sample; `parent`: of the layer before.
  struct Way {
    PathPlace place;
    double cost = 0;
    std::size_t parent = 0;
  };
  using Layer = std::vector<Way>;  ///< of one sample, the best first

  /// The places to which the axes may have come from one place until sample k. The moves that are looked at: as far as
  /// the axes went, and as far as the programmed feed leads.
  void add_ways(const Way& from, std::size_t parent, std::size_t k, Layer& out) const {
    const Vec3 point_mm = at(k);
    const double went_mm = (point_mm - at(k - 1)).norm(), most_mm = kAheadMm + kAheadFactor * went_mm;
    const double most_s = kAheadTime * (trace_.t_s[k] - trace_.t_s[k - 1]);
    double passed_mm = -from.place.u * length_mm_[from.place.move], passed_s = 0;
    for (std::uint32_t m = from.place.move; m < program_.moves.size(); ++m) {
      const nc::Move& move = program_.moves[m];
      if (!move.reference && move.kind != nc::MoveKind::dwell) {
        const double from_u = m == from.place.move ? from.place.u : 0.0;
        PathPlace here = feedmodel::closest_on_move(program_, m, point_mm, from_u, 1);
        if (move.kind == nc::MoveKind::rapid)
          here.distance_mm = std::min(here.distance_mm, off_rapid_mm(move, point_mm) + kOffRapid * here.distance_mm);
        const double way_mm = passed_mm + here.u * length_mm_[m];
        // The way is at least as long as its chord.
        const double cost = here.distance_mm + (way_mm < went_mm ? went_mm - way_mm : kDetour * (way_mm - went_mm));
        out.push_back({here, from.cost + cost, parent});
        if (is_feed(move) && move.feed_mm_per_s > 0) passed_s += (1 - from_u) * length_mm_[m] / move.feed_mm_per_s;
      }
      passed_mm += length_mm_[m];
      // The way to or from a reference point is not known; the axes may be anywhere after it.
      if (passed_mm > most_mm && passed_s > most_s && !move.reference) break;
    }
  }

  Layer next(const Layer& from, std::size_t k) const {
    Layer all, best;
    for (std::size_t i = 0; i < from.size(); ++i) add_ways(from[i], i, k, all);
    if (all.empty()) {
      for (std::size_t i = 0; i < from.size(); ++i) best.push_back({from[i].place, from[i].cost, i});
      return best;
    }
    std::ranges::stable_sort(all, {}, &Way::cost);
    const auto known = [&](const Way& way) {
      return std::ranges::any_of(
          best, [&](const Way& b) { return std::abs(along_mm(b.place) - along_mm(way.place)) < kSamePlaceMm; });
    };
    for (const Way& way : all) {
      if (best.size() == kMaxWays || way.cost > all.front().cost + kHopelessMm) break;
      if (!known(way)) best.push_back(way);
    }
    return best;
  }

  /// The axes of a rapid may go each by itself, anywhere between its ends.
  static double off_rapid_mm(const nc::Move& move, const Vec3& point_mm) {
    const Vec3 low = move.start_mm.cwiseMin(move.end_mm), high = move.start_mm.cwiseMax(move.end_mm);
    return (point_mm - point_mm.cwiseMax(low).cwiseMin(high)).norm();
  }

  double along_mm(const PathPlace& place) const { return from_mm_[place.move] + place.u * length_mm_[place.move]; }

  const ServoTrace& trace_;
  const nc::Interpretation& program_;
  Vec3 offset_mm_;
  std::vector<double> length_mm_, from_mm_;  ///< of each move; from_mm_: along the path
};

std::size_t first_motion(const ServoTrace& trace) {
  for (std::size_t k = 1; k < trace.size(); ++k)
    if ((position(trace, k) - position(trace, k - 1)).norm() > kStillMm) return k - 1;
  return 0;
}

struct Extent {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  void add(const Vec3& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
};

/// Returns the offset that takes the extent of the trace to that of the moves, where their sizes agree.
std::optional<Vec3> offset_of_extents(const ServoTrace& trace, const nc::Interpretation& program, bool with_rapids) {
  Extent of_trace, of_program;
  for (std::size_t k = 0; k < trace.size(); ++k) of_trace.add(position(trace, k));
  for (const nc::Move& move : program.moves) {
    if (move.reference || (!with_rapids && !is_feed(move))) continue;
    for (const double u : {0.0, 0.25, 0.5, 0.75, 1.0}) of_program.add(nc::point_at(program, move, u));
  }
  const Vec3 size = (of_trace.high - of_trace.low) - (of_program.high - of_program.low);
  if (!(size.cwiseAbs().maxCoeff() < kSameExtentMm)) return std::nullopt;
  return (of_program.low + of_program.high) / 2 - (of_trace.low + of_trace.high) / 2;
}

std::optional<PlacedTrace> placed_with(const ServoTrace& trace, const nc::Interpretation& program,
                                       const Vec3& offset_mm) {
  const Follower follower(trace, program, offset_mm);
  const std::size_t first = first_motion(trace), trial = std::min(trace.size(), first + kTrialSamples);
  PathPlace start;
  double least = std::numeric_limits<double>::infinity();
  for (const PathPlace& candidate : follower.starts(follower.at(first))) {
    cancellation_point();
    const double mean = follower.follow(candidate, first, trial, nullptr);
    if (mean >= least) continue;
    least = mean;
    start = candidate;
  }
  if (!std::isfinite(least)) return std::nullopt;
  PlacedTrace placed;
  placed.offset_mm = offset_mm;
  placed.place.assign(first, start);
  follower.follow(start, first, trace.size(), &placed.place);
  std::vector<double> off;
  for (std::size_t k = 0; k < trace.size(); ++k) {
    const std::size_t a = k > 0 ? k - 1 : k, b = std::min(k + 1, trace.size() - 1);
    const double speed = (position(trace, b) - position(trace, a)).norm() / (trace.t_s[b] - trace.t_s[a]);
    off.push_back(std::max(0.0, placed.place[k].distance_mm - kMaxOffPathS * speed));
  }
  const auto p95 = off.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(off.size() - 1));
  std::ranges::nth_element(off, p95);
  placed.off_path_p95_mm = *p95;
  if (*p95 > kMaxOffPathMm) return std::nullopt;
  return placed;
}

}  // namespace

std::optional<PlacedTrace> place_on_path(const ServoTrace& trace, const nc::Interpretation& program) {
  if (program.moves.empty() || trace.size() < 2) return std::nullopt;
  if (auto placed = placed_with(trace, program, Vec3::Zero())) return placed;
  for (const bool with_rapids : {true, false})
    if (const auto offset = offset_of_extents(trace, program, with_rapids))
      if (auto placed = placed_with(trace, program, *offset)) return placed;
  return std::nullopt;
}

void set_lines(ServoTrace& trace, const nc::Interpretation& program, const PlacedTrace& placed) {
  trace.line.assign(trace.size(), 0);
  for (std::size_t k = 0; k < trace.size(); ++k) {
    const std::size_t before = k > 0 ? k - 1 : k, after = std::min(k + 1, trace.size() - 1);
    const bool moves = (position(trace, after) - position(trace, before)).norm() > kStillMm;
    if (moves) trace.line[k] = program.moves[placed.place[k].move].block + 1;
  }
}

namespace {

/// A sample in motion within a run of feed moves.
struct Passage {
  std::size_t sample = 0;
  double sigma_s = 0;
};

/// How well a sample tells when the axes pass its place: they lag by another time where the speed changes, and where
/// they are off the path.
double passage_sigma_s(double before_mm_per_s, double after_mm_per_s, double step_s, double off_mm) {
  const double sum = after_mm_per_s + before_mm_per_s, change = std::abs(after_mm_per_s - before_mm_per_s) / sum;
  return std::hypot(kPassageS, std::min(kMaxLagChangeS, change * step_s / 4), off_mm / sum);
}

/// Samples of each run of feed moves, without those near its ends, where the axes hardly move.
class Passages {
 public:
  Passages(const ServoTrace& trace, const nc::Interpretation& program, const PlacedTrace& placed)
      : trace_(trace), placed_(placed), from_mm_{0.0} {
    for (const nc::Move& move : program.moves)
      from_mm_.push_back(from_mm_.back() + (move.reference ? 0 : nc::length_mm(program, move)));
  }

  std::vector<Passage> within(const FeedStretch& run, const Stretch& samples) const {
    std::vector<Passage> found;
    const auto moves = [&](std::size_t k) { return placed_.place[k].move; };
    const auto begin = placed_.place.begin();
    const auto first = std::lower_bound(begin + at(samples.first), begin + at(samples.end), run.move_first,
                                        [](const PathPlace& p, std::size_t m) { return p.move < m; });
    for (auto k = std::max<std::size_t>(samples.first + 1, static_cast<std::size_t>(first - begin));
         k + 1 < samples.end && moves(k) < run.move_end; ++k) {
      const double before = speed(k - 1, k), after = speed(k, k + 1), mean = speed(k - 1, k + 1);
      const bool inside = moves(k - 1) >= run.move_first && moves(k + 1) < run.move_end;
      if (!inside || std::min(before, after) < kMinEndSpeed * mean || mean <= 0) continue;
      found.push_back({k, passage_sigma_s(before, after, trace_.period_s, placed_.place[k].distance_mm)});
    }
    return found;
  }

 private:
  static std::ptrdiff_t at(std::size_t i) { return static_cast<std::ptrdiff_t>(i); }
  double along_mm(std::size_t k) const {
    const PathPlace& p = placed_.place[k];
    return from_mm_[p.move] + p.u * (from_mm_[p.move + 1] - from_mm_[p.move]);
  }
  double speed(std::size_t a, std::size_t b) const {
    return (along_mm(b) - along_mm(a)) / (trace_.t_s[b] - trace_.t_s[a]);
  }

  const ServoTrace& trace_;
  const PlacedTrace& placed_;
  std::vector<double> from_mm_;  ///< of each move, along the path
};

}  // namespace

std::vector<TimedStretch> placed_stretches(
    const ServoTrace& trace, const nc::Interpretation& program, const PlacedTrace& placed,
    const PlacingOptions& options,
    const std::function<std::optional<double>(double from_s, double to_s)>& override_between) {
  const Passages passages(trace, program, placed);
  std::vector<TimedStretch> out;
  for (const FeedStretch& run : feed_stretches(program)) {
    for (const Stretch& samples : trace.stretches) {
      const std::vector<Passage> found = passages.within(run, samples);
      for (std::size_t i = 0, k = 1; k < found.size(); ++k) {
        const double from_s = trace.t_s[found[i].sample], to_s = trace.t_s[found[k].sample];
        const bool last = k + 1 == found.size() && i == 0;
        if (to_s - from_s < options.piece_s && !last) continue;
        const PathPlace &from = placed.place[found[i].sample], &to = placed.place[found[k].sample];
        const double sigma_s = std::hypot(std::hypot(found[i].sigma_s, options.end_sigma_s),
                                          std::hypot(found[k].sigma_s, options.end_sigma_s));
        const auto feed = override_between ? override_between(from_s, to_s) : 1.0;
        Vec3 turn = Vec3::Zero();
        if (is_actual(trace))
          turn = direction_at(program, program.moves[to.move], to.u).cwiseAbs2() -
                 direction_at(program, program.moves[from.move], from.u).cwiseAbs2();
        if (feed)
          out.push_back(
              {piece_of(run, program, from.move, to.move + 1, from.u, to.u), to_s - from_s, sigma_s, *feed, turn});
        i = k;
      }
    }
  }
  return out;
}

}  // namespace camber::calib
