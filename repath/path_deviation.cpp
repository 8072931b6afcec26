#include "repath/path_deviation.h"

#include <algorithm>
#include <cmath>

namespace camber::repath {
namespace {

constexpr std::size_t kBins = 50;
constexpr double kSagittaFraction = 0.002;

/// Moves first ... last - 1 of a run.
struct Range {
  std::size_t first = 0, last = 0;
};

/// Returns the moves that the blocks of each run make; `first`, `last`: which blocks those are.
std::vector<Range> ranges_of(const nc::Interpretation& program, std::span<const RewrittenRun> runs,
                             std::uint32_t RewrittenRun::*first, std::uint32_t RewrittenRun::*last) {
  std::vector<Range> out(runs.size());
  for (std::size_t m = 0; m < program.moves.size(); ++m) {
    const nc::Move& move = program.moves[m];
    if (!move.editable || (move.kind != nc::MoveKind::linear && move.kind != nc::MoveKind::arc)) continue;
    const auto behind = std::upper_bound(runs.begin(), runs.end(), move.block,
                                         [&](std::uint32_t block, const RewrittenRun& r) { return block < r.*first; });
    if (behind == runs.begin()) continue;
    const auto k = static_cast<std::size_t>(behind - runs.begin()) - 1;
    if (move.block > runs[k].*last) continue;
    if (out[k].last == 0) out[k].first = m;
    out[k].last = m + 1;
  }
  return out;
}

/// A polyline that is followed from its start to its end.
class Chain {
 public:
  Chain(const nc::Interpretation& program, const Range& range, double sagitta_mm) {
    for (std::size_t m = range.first; m < range.last; ++m) {
      const nc::Move& move = program.moves[m];
      if (points_.empty()) add(move.start_mm);
      int n = 1;
      if (move.kind == nc::MoveKind::arc) {
        const nc::Arc& arc = program.arcs[move.arc];
        const double radius = (move.start_mm - arc.center_mm).norm();
        const double step = 2 * std::acos(std::max(0.0, 1 - sagitta_mm / std::max(radius, sagitta_mm)));
        n = std::max(2, static_cast<int>(std::ceil(std::abs(arc.sweep_rad) / step)));
      }
      for (int i = 1; i <= n; ++i) add(i == n ? move.end_mm : nc::point_at(program, move, static_cast<double>(i) / n));
    }
  }

  const std::vector<Vec3>& points() const { return points_; }
  double length_mm() const { return along_.empty() ? 0 : along_.back(); }

  /// Distance of a point that has gone on by `step_mm` at most since the one before.
  double follow(const Vec3& p, double step_mm, double tolerance_mm) {
    Foot best = nearest(p, 4 * (step_mm + tolerance_mm));
    if (best.distance_mm > tolerance_mm) best = nearest(p, 40 * (step_mm + tolerance_mm));  // there was a detour
    at_ = best.segment;
    return best.distance_mm;
  }
  void rewind() { at_ = 0; }

 private:
  struct Foot {
    double distance_mm;
    std::size_t segment;
  };

  void add(const Vec3& p) {
    if (!points_.empty() && p == points_.back()) return;
    along_.push_back(points_.empty() ? 0 : along_.back() + (p - points_.back()).norm());
    points_.push_back(p);
  }

  Foot nearest(const Vec3& p, double ahead_mm) const {
    Foot best{distance(p, at_), at_};
    const double from = along_[at_ + 1];
    for (std::size_t k = at_ + 1; k + 1 < points_.size() && along_[k] - from < ahead_mm; ++k)
      if (const double d = distance(p, k); d < best.distance_mm) best = {d, k};
    return best;
  }

  double distance(const Vec3& p, std::size_t k) const {
    const Vec3 a = points_[k], ab = points_[k + 1] - a;
    const double t = std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
    return (p - a - t * ab).norm();
  }

  std::vector<Vec3> points_;
  std::vector<double> along_;
  std::size_t at_ = 0;
};

class Measure {
 public:
  explicit Measure(double tolerance_mm) : tolerance_(tolerance_mm) {
    out_.limit_mm = tolerance_mm;
    out_.length_by_deviation_mm.assign(kBins, 0.0);
  }

  void add(Chain& before, Chain& after) {
    if (before.points().size() < 2 || after.points().size() < 2) return;
    const double step = 0.5 * before.length_mm() / static_cast<double>(before.points().size() - 1);
    along(after, before, step, true);
    along(before, after, std::numeric_limits<double>::infinity(), false);
    out_.length_mm += after.length_mm();
  }

  DeviationFigures figures() && { return std::move(out_); }

 private:
  /// Points of `path`, at most `max_mm` apart, and the middles of its segments, against the other.
  void along(const Chain& path, Chain& other, double max_mm, bool counted) {
    other.rewind();
    const auto& points = path.points();
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
      const double length = (points[k + 1] - points[k]).norm();
      const int n = std::max(2, static_cast<int>(std::ceil(length / max_mm)));
      for (int i = 1; i <= n; ++i) {
        const Vec3 p = points[k] + static_cast<double>(i) / n * (points[k + 1] - points[k]);
        const double away = other.follow(p, length / n, tolerance_);
        if (away > out_.max_mm) out_.max_mm = away, out_.worst_place_mm = p;
        if (!counted) continue;
        const auto bin = static_cast<std::size_t>(away / tolerance_ * kBins);
        out_.length_by_deviation_mm[std::min(bin, kBins - 1)] += length / n;
      }
    }
  }

  double tolerance_;
  DeviationFigures out_;
};

}  // namespace

DeviationFigures measure_deviation(const nc::Interpretation& before, const nc::Interpretation& after,
                                   std::span<const RewrittenRun> runs, double tolerance_mm) {
  const auto old_ranges = ranges_of(before, runs, &RewrittenRun::first_block, &RewrittenRun::last_block);
  const auto new_ranges = ranges_of(after, runs, &RewrittenRun::first_block_after, &RewrittenRun::last_block_after);
  Measure measure(tolerance_mm);
  for (std::size_t k = 0; k < runs.size(); ++k) {
    Chain old_chain(before, old_ranges[k], kSagittaFraction * tolerance_mm);
    Chain new_chain(after, new_ranges[k], kSagittaFraction * tolerance_mm);
    measure.add(old_chain, new_chain);
  }
  return std::move(measure).figures();
}

}  // namespace camber::repath
